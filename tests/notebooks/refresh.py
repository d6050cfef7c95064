"""Execute notebooks anew and write what they show, and what their solutions print, into them.

python tests/notebooks/refresh.py [notebooks/02_three_plants.ipynb ...]       all, if none is named
"""

import shutil
import sys
import tempfile
from pathlib import Path

import nbformat

sys.path.insert(0, str(Path(__file__).parents[1] / "helpers"))

from notebook_files import PATHS, execute, kernel, pages, solutions

METADATA = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}


def refresh(path):
    with tempfile.TemporaryDirectory() as folder, kernel() as client:
        notebook, shown = execute(path, folder, client)
        for name in pages(notebook):
            shutil.copyfile(Path(folder, name), path.parent / name)
    waiting = iter(shown)
    for number, cell in enumerate(notebook.cells, 1):
        for found in solutions(cell):
            start, end = (at - found.start() for at in found.span("shown"))
            text = f"{found[0][:start]}{next(waiting).rstrip()}\n{found[0][end:]}"
            cell.source = cell.source.replace(found[0], text)
        cell.id, tags = f"cell-{number:02}", cell.metadata.get("tags", [])
        folded = {"jupyter": {"source_hidden": True}} if "hide-input" in tags else {}
        cell.metadata = nbformat.from_dict({**folded, **({"tags": tags} if tags else {})})
    notebook.metadata = nbformat.from_dict(METADATA)
    nbformat.write(notebook, path)


if __name__ == "__main__":
    for each in [Path(name) for name in sys.argv[1:]] or PATHS:
        print(each, flush=True)
        refresh(each)
