"""The notebooks and their exercises run as they stand, and are committed with what they show."""

import json
import re
from typing import NamedTuple

import nbformat
import pytest
from claims import numbers_of, stated_in, unsupported
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook, new_output
from notebook_files import (
    NARROW,
    NOTEBOOKS,
    PATHS,
    code_cells,
    differences,
    execute,
    kernel,
    narrow_name,
    pages,
    pictures,
    printed,
    read,
    solutions,
)
from pages import blocks

PAGE_WIDTH = 90
"""Letters of an output that a page of the site shows on a line, at 1400 pixels."""

each_notebook = pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)


class Row(NamedTuple):
    """Row of a notebook in the table of the course."""

    number: str
    title: str
    question: str


TABLE = {
    file: Row(number, title, question)
    for number, title, file, question in re.findall(
        r"^\| \[(\d\d\w?) ([^\]]+)\]\(([^)]+)\) \| (.+) \|$",
        (NOTEBOOKS / "README.md").read_text(),
        re.MULTILINE,
    )
}


@pytest.fixture(scope="module")
def client():
    with kernel() as started:
        yield started


def kinds(cell):
    """Return what a cell shows, without the figures themselves."""
    return [sorted(o.get("data", {})) or o.get("name", o.output_type) for o in cell.outputs]


def same_page(committed, anew):
    """Two pages to drag along a front have the same program, and the same figures."""
    data = re.compile(r'(?<=<script type="application/json" id="data">).*?(?=</script>)')
    assert data.sub("", committed) == data.sub("", anew)
    then, now = (
        [
            [point["residual"], point["energy"]]
            for move in json.loads(data.search(page)[0])["moves"]
            for point in move["points"]
        ]
        for page in (committed, anew)
    )
    for before, after in zip(then, now, strict=True):
        assert after == pytest.approx(before, rel=1e-3, abs=1e-6)


@pytest.mark.slow
@each_notebook
def test_it_runs_without_warnings_and_shows_what_is_committed(path, client, tmp_path):
    committed = read(path)
    if any("import mujoco" in cell.source for cell in code_cells(committed)):
        pytest.importorskip("mujoco", reason="its simulator is MuJoCo, of the extra `notebook`")
    anew = execute(path, tmp_path, client)
    # it leaves nothing behind but the pages that it shows
    assert sorted(written.name for written in tmp_path.iterdir()) == pages(committed)
    for name in pages(committed):
        same_page((NOTEBOOKS / name).read_text(), (tmp_path / name).read_text())
    for then, now in zip(code_cells(committed), code_cells(anew.notebook), strict=True):
        assert "stderr" not in kinds(now), now.outputs
        assert kinds(then) == kinds(now), then.source
        if "varies" not in then.metadata.get("tags", []):
            assert differences(printed(then), printed(now)) == [], then.source
    folded = [found["shown"] for cell in committed.cells for found in solutions(cell)]
    for then, now in zip(folded, anew.solutions, strict=True):
        assert differences(then, now) == []


@each_notebook
def test_it_is_committed_as_refresh_writes_it(path):
    notebook = read(path)
    nbformat.validate(notebook)
    counts = [cell.execution_count for cell in code_cells(notebook)]
    assert counts == list(range(1, len(counts) + 1))
    for cell in notebook.cells:
        tags = cell.metadata.get("tags", [])
        assert set(tags) <= {"varies", "hide-input"}
        assert ("jupyter" in cell.metadata) == ("hide-input" in tags)
    assert path.stat().st_size < 700_000
    assert min(map(len, pictures(notebook))) > 10_000  # something is drawn in each


def test_the_table_of_the_course_has_every_notebook_in_its_order():
    assert list(TABLE) == [path.name for path in PATHS]


@each_notebook
def test_it_begins_with_its_question_and_ends_with_what_was_seen(path):
    first, *_, last = read(path).cells
    assert first.source.split("\n\n")[0].startswith("# ")
    assert first.source.split("\n\n")[1] == f"**{TABLE[path.name].question}**"
    heading, sentences, following = last.source.split("\n\n")
    assert heading == "## What you saw"
    lines = sentences.split("\n")
    assert len(lines) == 3
    for line in lines:
        assert re.fullmatch(r"- [A-Z](?:(?!\. [A-Z]).)*\.", line), "one sentence"
    if path == PATHS[-1]:
        assert following.startswith("**Next:** [")
        assert "](../docs/choose.md)" in following
    else:
        after = PATHS[PATHS.index(path) + 1].name
        number, title, question = TABLE[after]
        assert following == f"**Next:** notebook {number}, [{title}]({after}). {question}"


def test_the_arm_of_the_simulator_is_that_of_its_page():
    (path,) = NOTEBOOKS.glob("15_*.ipynb")
    (model,) = blocks("simulators", "xml")
    assert sum(model in cell.source for cell in code_cells(read(path))) == 1


@each_notebook
def test_its_pictures_have_variants_for_phones(path):
    names = {narrow_name(path, picture) for picture in pictures(read(path))}
    files = {file.name for file in NARROW.glob(f"{path.stem.partition('_')[0]}-*.png")}
    assert files == names, "run python tests/notebooks/refresh.py"


@each_notebook
def test_its_outputs_fit_a_page_and_its_pictures_say_what_is_seen(path):
    for cell in code_cells(read(path)):
        wide = [line for line in printed(cell).splitlines() if len(line.rstrip()) > PAGE_WIDTH]
        assert wide == [] or "text/html" in cell.outputs[-1].get("data", {})
        for output in cell.outputs:
            picture = output.get("metadata", {}).get("image/png", {})
            assert not picture or re.match(r"[A-Z0-9]", picture["alt"]), "a sentence above it"


@each_notebook
def test_its_headings_begin_cells_and_its_questions_sentences(path):
    for cell in read(path).cells:
        if cell.cell_type == "markdown":
            text = re.sub(r"<details>.*?</details>", "", cell.source, flags=re.DOTALL)
            assert "\n#" not in text
            for question in re.findall(r"\*\*([^*]+\?)\*\*", text):
                assert question[0].isupper() or question[0] in "0123456789`$", question


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


@each_notebook
def test_numbers_of_its_text_are_those_of_its_outputs(path):
    without_source, stated_needlessly = unsupported(read(path), stated_in(path))
    assert without_source == [], "correct the text, or say in stated.toml where the number is from"
    assert stated_needlessly == []


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("It takes 23.68 mJ.", []),
        ("It takes 23.7 mJ, some 24 mJ.", []),  # rounded
        ("It takes 23.53 mJ, 23.6 mJ, or 25 mJ.", ["23.53", "23.6", "25"]),
        ("The other takes 91.15 mJ, the first saves 74 %.", ["74"]),
        ("A move of 0.8 s within 5 mm.", []),  # of the program, in its units
        ("## 7 headings\n\nIt takes 23.53 mJ, by 60 degrees.", ["23.53"]),
        ("1. A move, as in 05a.", []),
        ("As in notebooks 01 and 12, by (11) and Table 2, $N = 7$, `plan(9)`.", []),
    ],
)
def test_a_number_that_no_output_shows_is_found(text, wrong):
    shown = new_output("stream", name="stdout", text="F2 = 23.678 mJ\n91.15 mJ without\n")
    program = new_code_cell("move(pi / 3, 0.8, residual_limit=5e-3)", outputs=[shown])
    notebook = new_notebook(cells=[program, new_markdown_cell(text)])
    assert unsupported(notebook) == (wrong, [])
    assert unsupported(notebook, [*wrong, "1.5"]) == ([], ["1.5"])


def test_an_output_far_above_a_text_does_not_count():
    cells = [
        new_code_cell("", outputs=[new_output("stream", name="stdout", text=f"{number}\n")])
        for number in (1.25, 2.25, 3.25, 4.25)
    ]
    notebook = new_notebook(cells=[*cells, new_markdown_cell("1.25, then 2.25 and 4.25.")])
    assert unsupported(notebook) == (["1.25"], [])
    assert numbers_of("1,681 cells and \u22120.1") == ["1,681", "\u22120.1"]
