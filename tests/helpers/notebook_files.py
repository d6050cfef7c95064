"""Notebooks as files: what they show, their folded solutions, and how they are executed anew."""

import base64
import hashlib
import math
import re
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import nbformat
from nbclient import NotebookClient
from nbformat.v4 import new_code_cell, new_notebook

HERE = str(Path(__file__).parent)
NOTEBOOKS = Path(__file__).parents[2] / "notebooks"
PATHS = sorted(NOTEBOOKS.glob("*.ipynb"))
NARROW = NOTEBOOKS / "narrow"
"""Where the pictures of notebooks for phones are."""

SOLUTION = re.compile(r"```python\n(?P<code>.*?)```\n+```text\n(?P<shown>.*?)```", re.DOTALL)
"""What a solution computes and what that prints; `refresh.py` writes the second."""

WIDGET = "application/vnd.jupyter.widget-view+json"
"""What a slider shows where a kernel runs; a file keeps the picture that stands beside it."""

STRICT = """
%reset -f
import os, sys, warnings

os.chdir({folder!r})
sys.path.insert(0, {here!r})
import described  # gives pictures their alternative texts

sys.path.remove({here!r})
sys.path.append({notebooks!r})  # for their checks; a reader's folder is in the clone
warnings.simplefilter("error")
warnings.filterwarnings("ignore", module="ipykernel")  # of its own ways, when it shuts down
"""

NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?%?")
NOTHING = 1e-5
"""Below this a residual at rest is what an integrator leaves, in any unit that is printed."""


class Executed(NamedTuple):
    """A notebook after its execution, what its solutions printed, and its pictures for phones."""

    notebook: nbformat.NotebookNode
    solutions: list[str]
    narrow: dict[str, bytes]
    """By the name of the file, which has that of the notebook and of the picture's content."""


def read(path):
    return nbformat.read(path, as_version=4)


def code_cells(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def solutions(cell):
    """Find code and printed text of the solution that is folded in a markdown cell."""
    folded = cell.cell_type == "markdown" and "<details>" in cell.source
    return list(SOLUTION.finditer(cell.source)) if folded else []


def printed(cell):
    """All text that a code cell shows, but for the names of its pictures and sliders."""
    text = ""
    for output in cell.outputs:
        if output.output_type == "stream":
            text += output.text if output.name == "stdout" else ""
        elif not {"image/png", WIDGET} & set(output.get("data", {})):
            data = output.get("data", {})
            table = re.sub(r"<[^>]*>", " ", data.get("text/html", ""))
            text += (table or data.get("text/plain", "")) + "\n"
    return text


def pictures(notebook):
    outputs = [output for cell in code_cells(notebook) for output in cell.outputs]
    found = [output.get("data", {}).get("image/png") for output in outputs]
    return [base64.b64decode(picture) for picture in found if picture]


def pages(notebook):
    """Names of the pages that its cells write and show in a frame."""
    outputs = [output for cell in code_cells(notebook) for output in cell.outputs]
    shown = "".join(output.get("data", {}).get("text/html", "") for output in outputs)
    return sorted(re.findall(r'<iframe[^>]*src="([\w.-]+\.html)"', shown.replace("\n", " ")))


@contextmanager
def kernel():
    """Yield what executes notebooks: a kernel that loads modules once for all of them."""
    client = NotebookClient(new_notebook(), timeout=600, coalesce_streams=True, record_timing=False)
    with client.setup_kernel():
        yield client


def execute(path, folder, client):
    """Execute a notebook and its solutions in a folder, with a clean namespace and strict warnings.

    Raises nbclient's CellExecutionError, with the cell and its traceback, where one fails.
    """
    notebook = read(path)
    begin, extra = (
        new_code_cell(STRICT.format(folder=str(folder), here=HERE, notebooks=str(NOTEBOOKS))),
        [],
    )
    cells = [begin]
    for cell in notebook.cells:
        found = [new_code_cell(each["code"]) for each in solutions(cell)]
        cells += [cell, *found]
        extra += found
    client.nb = new_notebook(cells=cells, metadata=notebook.metadata)
    client.execute(cleanup_kc=False)
    for number, cell in enumerate(code_cells(notebook), 1):
        cell.execution_count = number
        for output in cell.outputs:
            if "execution_count" in output:
                output.execution_count = number
            data = output.get("data", {})
            data.pop(WIDGET, None)
            if "text/html" in data:
                data.pop("text/plain", None)
    return Executed(
        notebook, [printed(cell) for cell in extra], _pictures_for_phones(notebook, path)
    )


def _pictures_for_phones(notebook, path):
    """Take the narrow variants of pictures out of a notebook, where `described` has put them."""
    variants = {}
    for output in (output for cell in code_cells(notebook) for output in cell.outputs):
        narrow = output.get("metadata", {}).get("image/png", {}).pop("narrow", "")
        if narrow:
            picture = base64.b64decode(output.data["image/png"])
            variants[narrow_name(path, picture)] = base64.b64decode(narrow)
    return variants


def narrow_name(path, picture):
    """Return the name of the file for phones of a notebook's picture, in `NARROW`."""
    return f"{path.stem.partition('_')[0]}-{hashlib.sha256(picture).hexdigest()[:16]}.png"


def differences(committed, anew):
    """List what two executions print differently: words exactly, numbers within their last digit.

    Whole numbers are counts and equal; others agree in all digits but the last, or to 0.1 %.
    """
    words = [NUMBER.sub("#", text).split() for text in (committed, anew)]
    if words[0] != words[1]:
        return [(committed, anew)]
    pairs = zip(NUMBER.findall(committed), NUMBER.findall(anew), strict=True)
    return [pair for pair in pairs if not _same(*pair)]


def _same(one, other):
    a, b = (float(text.rstrip("%")) for text in (one, other))
    if re.fullmatch(r"[-+]?\d+", one):
        return a == b
    digits, _, exponent = one.rstrip("%").lower().partition("e")
    last_digit = 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))
    at_rest = max(abs(a), abs(b)) < NOTHING
    return at_rest or math.isclose(a, b, rel_tol=1e-3, abs_tol=1.01 * last_digit)
