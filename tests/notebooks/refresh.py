"""Execute notebooks anew and write what they show, and what their solutions print, into them.

python tests/notebooks/refresh.py [notebooks/02_three_plants.ipynb ...]       all, if none is named
"""

import shutil
import sys
import tempfile
from pathlib import Path

import nbformat

sys.path.insert(0, str(Path(__file__).parents[1] / "helpers"))

from notebook_files import NARROW, PATHS, execute, kernel, pages, solutions

METADATA = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}


def refresh(path):
    with tempfile.TemporaryDirectory() as folder, kernel() as client:
        notebook, shown, narrow = execute(path, folder, client)
        for name in pages(notebook):
            shutil.copyfile(Path(folder, name), path.parent / name)
    replace_narrow(path, narrow)
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


def replace_narrow(path, narrow):
    """Write the pictures of a notebook for phones, and remove those that it had before."""
    NARROW.mkdir(exist_ok=True)
    for before in NARROW.glob(f"{path.stem.partition('_')[0]}-*.png"):
        if before.name not in narrow:
            before.unlink()
    for name, picture in narrow.items():
        (NARROW / name).write_bytes(picture)


if __name__ == "__main__":
    for each in [Path(name) for name in sys.argv[1:]] or PATHS:
        print(each, flush=True)
        refresh(each)
