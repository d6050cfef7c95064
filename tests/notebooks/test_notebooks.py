"""The notebooks run as they stand, and are committed with what they show."""

import base64
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

NOTEBOOKS = Path(__file__).parent.parent.parent / "notebooks"
PATHS = sorted(NOTEBOOKS.glob("*.ipynb"))

each_notebook = pytest.mark.parametrize("path", PATHS, ids=lambda path: path.name)


def code_cells(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def kinds(notebook):
    """What every code cell shows, without the figures themselves."""
    return [
        [sorted(output.get("data", {})) or output.get("name", output.output_type)]
        for cell in code_cells(notebook)
        for output in cell.outputs
    ]


def pictures(notebook):
    found = [
        output.get("data", {}).get("image/png")
        for cell in code_cells(notebook)
        for output in cell.outputs
    ]
    return [base64.b64decode(picture) for picture in found if picture]


@pytest.fixture(scope="module", params=PATHS, ids=lambda path: path.name)
def both(request, tmp_path_factory):
    """A notebook as committed and executed anew, in a folder that is not the repository's."""
    committed = nbformat.read(request.param, as_version=4)
    anew = nbformat.read(request.param, as_version=4)
    for cell in code_cells(anew):
        cell.outputs, cell.execution_count = [], None
    folder = tmp_path_factory.mktemp("notebook")
    # Raises CellExecutionError, with the cell and its traceback, where one fails.
    NotebookClient(anew, timeout=600, resources={"metadata": {"path": str(folder)}}).execute()
    return committed, anew, folder


def test_there_is_the_notebook_of_the_readme():
    assert "01_plan_a_move.ipynb" in [path.name for path in PATHS]


def test_it_runs_and_writes_no_warning(both):
    _, anew, _ = both
    shown = [output for cell in code_cells(anew) for output in cell.outputs]
    assert shown
    assert [o for o in shown if o.output_type == "error" or o.get("name") == "stderr"] == []


def test_it_leaves_nothing_behind(both):
    assert list(both[2].iterdir()) == []


def test_it_shows_the_same_kinds_of_things_as_committed(both):
    committed, anew, _ = both
    assert kinds(anew) == kinds(committed)
    assert len(pictures(anew)) >= 1


@each_notebook
def test_it_is_committed_executed_from_top_to_bottom(path):
    cells = code_cells(nbformat.read(path, as_version=4))
    assert [cell.execution_count for cell in cells] == list(range(1, len(cells) + 1))
    assert any(cell.outputs for cell in cells)


@each_notebook
def test_it_is_committed_without_errors_or_the_traces_of_one_run(path):
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    assert set(notebook.metadata) <= {"kernelspec", "language_info"}
    assert set(notebook.metadata.language_info) == {"name"}
    assert [dict(cell.metadata) for cell in notebook.cells] == [{}] * len(notebook.cells)
    assert not [o for c in code_cells(notebook) for o in c.outputs if o.output_type == "error"]


@each_notebook
def test_its_pictures_are_pictures(path):
    for picture in pictures(nbformat.read(path, as_version=4)):
        assert picture.startswith(b"\x89PNG\r\n\x1a\n")
        assert len(picture) > 10_000  # something is drawn


@each_notebook
def test_it_is_small_enough_to_be_committed(path):
    assert path.stat().st_size < 700_000


def test_the_picture_of_the_readme_is_the_last_of_the_first_notebook():
    first = nbformat.read(NOTEBOOKS / "01_plan_a_move.ipynb", as_version=4)
    assert (NOTEBOOKS / "move.png").read_bytes() == pictures(first)[-1]
