"""A handout has the notebook's cells without answers; the sheet has every answer."""

import subprocess
import sys

import handout
import pytest
from notebook_files import NOTEBOOKS, PATHS, SOLUTION, code_cells, read

HANDOUT = NOTEBOOKS / "handout.py"


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_answers_are_on_the_sheet_and_nowhere_else(path):
    notebook = read(path)
    given = handout.handout_of(notebook)
    sheet = handout.solutions_of(notebook, path.stem)
    assert len(given.cells) == len(notebook.cells)
    assert not any(cell.outputs for cell in code_cells(given))
    text = "\n".join(cell.source for cell in given.cells)
    assert "<details>" not in text
    assert "unfold its solution" not in text
    solutions = [
        match["code"] for cell in notebook.cells for match in SOLUTION.finditer(cell.source)
    ]
    assert len(solutions) == 3
    assert all(code in sheet and code not in text for code in solutions)
    assert all(f"**{number}. " in text and f"**{number}. " in sheet for number in (1, 2, 3))
    assert read(path) == notebook  # what the clone has is not touched


def test_the_command_writes_both_and_replaces_no_notebook(tmp_path):
    path = PATHS[0]
    words = [sys.executable, HANDOUT, path, "--output"]
    answer = subprocess.run([*words, tmp_path], capture_output=True, text=True, check=True).stdout
    written = [tmp_path / path.name, tmp_path / f"{path.stem}.solutions.md"]
    assert answer == "".join(f"wrote {name}\n" for name in written)
    assert all(name.is_file() for name in written)
    refused = subprocess.run([*words, NOTEBOOKS], capture_output=True, text=True)
    assert refused.returncode == 1
    assert (
        refused.stderr == f"{NOTEBOOKS}: the handout would replace {path}; give another --output\n"
    )
