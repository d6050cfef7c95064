"""Execute notebooks anew and write what they show, and what their solutions print, into them.

python tests/notebooks/refresh.py [notebooks/02_the_plants.ipynb ...]       all, if none is named
"""

import sys
import tempfile
from pathlib import Path

import nbformat

sys.path.insert(0, str(Path(__file__).parents[1] / "helpers"))

from notebook_files import PATHS, SOLUTION, execute, kernel, solutions
from slides import slide_types

METADATA = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}


def refresh(path):
    with tempfile.TemporaryDirectory() as folder, kernel() as client:
        notebook, shown = execute(path, folder, client)
    waiting = iter(shown)
    for cell in notebook.cells:
        for found in solutions(cell.source) if cell.cell_type == "markdown" else []:
            cell.source = cell.source.replace(found[0], _with_text(found[0], next(waiting)))
    places = slide_types(notebook.cells)  # by what stands in the cells now
    for number, (cell, place) in enumerate(zip(notebook.cells, places, strict=True), 1):
        cell.id = f"cell-{number:02}"
        tags = {"tags": cell.metadata.tags} if cell.metadata.get("tags") else {}
        slide = {"slideshow": {"slide_type": place}} if place != "-" else {}
        cell.metadata = nbformat.from_dict({**slide, **tags})
    notebook.metadata = nbformat.from_dict(METADATA)
    nbformat.write(notebook, path)


def _with_text(solution, text):
    found = SOLUTION.fullmatch(solution)
    start, end = found.span("shown")
    return solution[:start] + text.rstrip("\n") + "\n" + solution[end:]


if __name__ == "__main__":
    for each in [Path(name) for name in sys.argv[1:]] or PATHS:
        print(each)
        refresh(each)
