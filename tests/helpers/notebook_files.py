"""Notebooks as files: what they show, their folded solutions, and how they are executed anew."""

import base64
import logging
import re
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import nbformat
from nbclient import NotebookClient
from nbformat.v4 import new_code_cell, new_notebook

HERE = str(Path(__file__).parent)
ROOT = Path(__file__).parents[2]
NOTEBOOKS = ROOT / "notebooks"
PATHS = sorted(NOTEBOOKS.glob("*.ipynb"))
EXECUTED = ROOT / "build" / "notebooks"
"""Where a notebook is kept as it was executed last: the tests leave them there for the site."""

FOLDED = re.compile(r"<details>\n<summary>Solution</summary>\n(.*?)</details>", re.DOTALL)
"""A solution, folded wherever a notebook is shown: in JupyterLab, as HTML, on slides."""

SOLUTION = re.compile(r"```python\n(?P<code>.*?)```\n+```text\n(?P<shown>.*?)```", re.DOTALL)
"""What a solution computes and what that prints; `refresh.py` writes the second."""

WIDGET = "application/vnd.jupyter.widget-view+json"
"""What a slider shows where a kernel runs; a file keeps the picture that stands beside it."""

STRICT = """
%reset -f
import os
import sys
import warnings

os.chdir({folder!r})
sys.path.insert(0, {here!r})
import described  # gives pictures their alternative texts

sys.path.remove({here!r})
warnings.simplefilter("error")
warnings.filterwarnings("ignore", module="ipykernel")  # of its own ways, when it shuts down
"""


class Executed(NamedTuple):
    """A notebook after its execution, and what its solutions printed, in order."""

    notebook: nbformat.NotebookNode
    solutions: list[str]


def read(path):
    return nbformat.read(path, as_version=4)


def code_cells(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def solutions(source):
    """Find code and printed text of the solutions that are folded in a markdown cell."""
    return [found for folded in FOLDED.findall(source) for found in SOLUTION.finditer(folded)]


def printed(cell):
    """All text that a code cell shows, but for the names of its pictures and sliders."""
    text = ""
    for output in cell.outputs:
        if output.output_type == "stream":
            text += output.text if output.name == "stdout" else ""
        elif not {"image/png", WIDGET} & set(output.get("data", {})):
            text += output.get("data", {}).get("text/plain", "") + "\n"
    return text


def pictures(notebook):
    outputs = [output for cell in code_cells(notebook) for output in cell.outputs]
    found = [output.get("data", {}).get("image/png") for output in outputs]
    return [base64.b64decode(picture) for picture in found if picture]


@contextmanager
def kernel():
    """What executes notebooks: a kernel that loads modules once for all of them."""
    client = NotebookClient(new_notebook(), timeout=600, coalesce_streams=True, record_timing=False)
    with client.setup_kernel():
        yield client


def execute(path, folder, client):
    """Execute a notebook and its solutions in a folder, with a clean namespace and strict warnings.

    Raises nbclient's CellExecutionError, with the cell and its traceback, where one fails.
    """
    notebook = read(path)
    extra = [new_code_cell(STRICT.format(folder=str(folder), here=HERE))]
    cells = list(extra)
    for cell in notebook.cells:
        cells.append(cell)
        if cell.cell_type == "code":
            cell.outputs, cell.execution_count = [], None
        else:
            found = [new_code_cell(each["code"]) for each in solutions(cell.source)]
            cells += found
            extra += found
    client.nb = new_notebook(cells=cells, metadata=notebook.metadata)
    client.execute(cleanup_kc=False)
    for number, cell in enumerate(code_cells(notebook), 1):
        _keep_what_lasts(cell, number)
    return Executed(notebook, [_shown_by(cell) for cell in extra[1:]])


def keep(path, executed):
    """Keep an executed notebook for the site."""
    EXECUTED.mkdir(parents=True, exist_ok=True)
    nbformat.write(executed.notebook, EXECUTED / path.name)


def execute_those_that_changed():
    """Execute and keep every notebook that was not since it, or the code that it runs, changed."""
    logging.getLogger("traitlets").setLevel(logging.ERROR)  # it names the kernel each time
    packages = ("models", "ocp", "metaheuristics", "studies", "quietarm")
    code = [file for name in packages for file in (ROOT / name).rglob("*") if file.is_file()]
    changed = max(file.stat().st_mtime for file in code if "__pycache__" not in file.parts)
    kept = {path: path.stat().st_mtime for path in EXECUTED.glob("*.ipynb")}
    old = [
        path
        for path in PATHS
        if kept.get(EXECUTED / path.name, 0) < max(changed, path.stat().st_mtime)
    ]
    if not old:
        return
    with kernel() as client, TemporaryDirectory() as folder:
        for path in old:
            keep(path, execute(path, folder, client))


def _keep_what_lasts(cell, number):
    """Number a cell as in the notebook, and drop what only a running kernel can show."""
    cell.execution_count = number
    for output in cell.outputs:
        if "execution_count" in output:
            output.execution_count = number
        output.get("data", {}).pop(WIDGET, None)


def _shown_by(cell):
    assert all(output.get("name") != "stderr" for output in cell.outputs), cell.outputs
    return printed(cell)
