"""Write a handout of a notebook for students, and its solutions on a sheet of their own.

    python notebooks/handout.py [--output FOLDER] NOTEBOOK...

The handout is the notebook without solutions and without outputs: the class runs every cell.
The sheet, `NAME.solutions.md`, repeats each exercise with its solution and what that prints.
"""

import argparse
import re
import sys
from pathlib import Path

import nbformat

_SOLUTION = re.compile(
    r"\n*<details>\s*<summary>Solution</summary>\n*(?P<solution>.*?)\n*</details>\n*", re.DOTALL
)
_UNFOLD = "Try each before you unfold its solution. "


def handout_of(notebook):
    """Return a copy of a notebook that has neither solutions nor outputs."""
    handout = notebook.copy()
    handout.cells = [_without_answers(cell) for cell in notebook.cells]
    return handout


def solutions_of(notebook, title):
    """Return the sheet of solutions [Markdown]: each exercise, its solution, what that prints."""
    answered = [cell for cell in notebook.cells if _SOLUTION.search(cell.source)]
    exercises = [_SOLUTION.sub(_unfolded, cell.source).strip() for cell in answered]
    return "\n\n".join([f"# Solutions: {title}", *exercises]) + "\n"


def _without_answers(cell):
    cell = cell.copy()
    if cell.cell_type == "markdown":
        cell.source = _SOLUTION.sub("", cell.source).replace(_UNFOLD, "")
    else:
        cell.outputs = []
        cell.execution_count = None
    return cell


def _unfolded(match):
    return f"\n\n{match['solution']}\n"


def main():
    """Write the files, and print the name of each."""
    words = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    words.add_argument("notebooks", nargs="+", type=Path, metavar="NOTEBOOK")
    words.add_argument("--output", type=Path, default=Path("handouts"), help="the folder")
    arguments = words.parse_args()
    for path in arguments.notebooks:
        if not path.is_file():
            sys.exit(f"{path}: no such notebook")
        if path.parent.resolve() == arguments.output.resolve():
            sys.exit(f"{arguments.output}: the handout would replace {path}; give another --output")
    arguments.output.mkdir(parents=True, exist_ok=True)
    for path in arguments.notebooks:
        notebook = nbformat.read(path, as_version=4)
        handout = arguments.output / path.name
        nbformat.write(handout_of(notebook), handout)
        print("wrote", handout)
        sheet = arguments.output / f"{path.stem}.solutions.md"
        sheet.write_text(solutions_of(notebook, path.stem), encoding="utf-8")
        print("wrote", sheet)


if __name__ == "__main__":
    main()
