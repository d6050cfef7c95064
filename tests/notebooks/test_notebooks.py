"""The notebooks and their exercises run as they stand, and are committed with what they show."""

import re

import nbformat
import pytest
from notebook_files import (
    NOTEBOOKS,
    PATHS,
    code_cells,
    execute,
    keep,
    kernel,
    pictures,
    printed,
    read,
    solutions,
)
from same_numbers import differences
from slides import WALL, slide_heights, slide_types

A_FEW_LINES = 100
"""Of pixels: a slide with less on it belongs to its neighbour."""

each_notebook = pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)


@pytest.fixture(scope="module")
def client():
    with kernel() as started:
        yield started


@pytest.fixture(scope="module", params=PATHS, ids=lambda path: path.stem)
def both(request, client, tmp_path_factory):
    """A notebook as committed and executed anew, in a folder that is not the repository's."""
    folder = tmp_path_factory.mktemp("notebook")
    executed = execute(request.param, folder, client)
    keep(request.param, executed)
    return read(request.param), executed, folder


def kinds(notebook):
    """What every code cell shows, without the figures themselves."""
    return [
        [sorted(output.get("data", {})) or output.get("name", output.output_type)]
        for cell in code_cells(notebook)
        for output in cell.outputs
    ]


def folded(notebook):
    return [
        found["shown"]
        for cell in notebook.cells
        if cell.cell_type == "markdown"
        for found in solutions(cell.source)
    ]


def test_it_runs_and_writes_no_warning(both):
    _, anew, folder = both
    shown = [output for cell in code_cells(anew.notebook) for output in cell.outputs]
    assert shown
    assert [o for o in shown if o.output_type == "error" or o.get("name") == "stderr"] == []
    assert list(folder.iterdir()) == []  # it leaves nothing behind


def test_it_shows_the_same_kinds_of_things_as_committed(both):
    committed, anew, _ = both
    assert kinds(anew.notebook) == kinds(committed)


def test_it_prints_the_numbers_that_are_committed(both):
    committed, anew, _ = both
    for then, now in zip(code_cells(committed), code_cells(anew.notebook), strict=True):
        if "varies" not in then.metadata.get("tags", []):
            assert differences(printed(then), printed(now)) == [], then.source


def test_its_solutions_print_what_they_say(both):
    committed, anew, _ = both
    for then, now in zip(folded(committed), anew.solutions, strict=True):
        assert differences(then, now) == []


@each_notebook
def test_it_says_first_what_it_is_for_and_last_has_three_exercises(path):
    cells = read(path).cells
    assert cells[0].source.startswith("# ")
    assert "**You will be able to**" in cells[0].source
    assert "**You need**" in cells[0].source
    exercises = [c for c in cells if c.cell_type == "markdown" and solutions(c.source)]
    assert len(exercises) == sum("<details>" in cell.source for cell in cells) == 3
    headings = [cell.source for cell in cells if re.search(r"^## ", cell.source, re.MULTILINE)]
    assert [text for text in headings if not text.startswith("## ")] == []  # slides begin there
    begin = next(n for n, cell in enumerate(cells) if cell.source.startswith("## Exercises"))
    assert all(cells.index(exercise) >= begin for exercise in exercises)


@each_notebook
def test_it_is_committed_executed_from_top_to_bottom(path):
    cells = code_cells(read(path))
    assert [cell.execution_count for cell in cells] == list(range(1, len(cells) + 1))
    assert any(cell.outputs for cell in cells)


@each_notebook
def test_it_is_committed_without_errors_or_the_traces_of_one_run(path):
    notebook = read(path)
    nbformat.validate(notebook)
    assert set(notebook.metadata) <= {"kernelspec", "language_info"}
    assert set(notebook.metadata.language_info) == {"name"}
    for cell in notebook.cells:
        assert set(cell.metadata) <= {"slideshow", "tags"}
        assert set(cell.metadata.get("tags", [])) <= {"varies"}
    assert not [o for c in code_cells(notebook) for o in c.outputs if o.output_type == "error"]


@each_notebook
def test_its_slides_follow_its_headings_and_answers(path):
    cells = read(path).cells
    placed = [cell.metadata.get("slideshow", {}).get("slide_type", "-") for cell in cells]
    assert placed == slide_types(cells)


@each_notebook
def test_its_slides_are_neither_higher_than_the_wall_nor_nearly_empty(path):
    heights = slide_heights(read(path).cells)
    assert max(heights) <= WALL
    assert min(heights) >= A_FEW_LINES


@each_notebook
def test_its_pictures_are_pictures_and_it_is_small_enough_to_be_committed(path):
    assert path.stat().st_size < 700_000
    found = pictures(read(path))
    assert found
    for picture in found:
        assert picture.startswith(b"\x89PNG\r\n\x1a\n")
        assert len(picture) > 10_000  # something is drawn


def test_the_picture_of_the_documentation_is_the_last_of_the_first_notebook():
    first = read(NOTEBOOKS / "01_plan_a_move.ipynb")
    assert (NOTEBOOKS / "move.png").read_bytes() == pictures(first)[-1]


def test_the_list_of_notebooks_has_every_one():
    text = (NOTEBOOKS / "README.md").read_text()
    assert [path.name for path in PATHS if f"]({path.name})" not in text] == []


@pytest.mark.parametrize(
    ("then", "now", "same"),
    [
        ("F1 = 77.1146 mm", "F1 =   77.1145 mm", True),  # the last digit, and a wider column
        ("F1 = 77.1146 mm", "F1 = 77.2146 mm", False),
        ("F1 = 77.1146 mm", "F2 = 77.1146 mm", False),
        ("5.0e-07 mm", "3.2e-08 mm", True),  # at rest, both
        ("26% of it", "27% of it", True),  # rounded
        ("26% of it", "36% of it", False),
        ("3 of 5 seeds", "4 of 5 seeds", False),  # counts are equal
        ("-0.25", "0.25", False),
    ],
)
def test_numbers_are_compared_within_their_last_digit(then, now, same):
    assert (differences(then, now) == []) is same
