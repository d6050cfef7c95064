"""Reports in each of their forms, from one template."""

import re
from io import StringIO
from xml.etree import ElementTree

import pandas as pd
import pytest
from matplotlib.figure import Figure
from rich.console import Console

from quietarm.views.report import Report, show, show_facts

MOVES = pd.DataFrame(
    {
        "method": ["nsga2 | paper", "epsilon"],
        "energy [J]": [0.0236835, float("nan")],
        "runs": [3, 5],
    }
)


@pytest.fixture
def example(tmp_path):
    """A report of a template of one's own."""
    template = tmp_path / "moves.md"
    template.write_text(
        "# Moves of {{ plant }}\n\n{{ tables.moves | table }}\n\n![front](front.png)\n"
    )
    return Report(template, {"plant": "a < b & c"}, {"moves": MOVES}, {"front.png": Figure})


def test_markdown_has_four_digits_and_a_dash_where_there_is_no_value(example):
    lines = example.markdown().splitlines()
    cells = re.split(r"(?<!\\)\|", lines[4])[1:-1]
    assert [cell.strip() for cell in cells] == [r"nsga2 \| paper", "0.02368", "3"]
    assert [cell.strip() for cell in lines[5].split("|")[1:-1]] == ["epsilon", "-", "5"]


def test_html_is_well_formed_and_holds_its_pictures(example):
    page = ElementTree.fromstring(example.html().replace("<!DOCTYPE html>", ""))
    assert page.find("head/title").text == "Moves of a < b & c"
    assert page.find(".//img").get("src").startswith("data:image/svg+xml;base64,")
    assert [cell.text for cell in page.findall(".//tbody/tr/td")][1] == "0.02368"


def test_latex_escapes_and_has_a_label(example):
    assert r"\label{tab:moves}" in example.latex()
    assert "energy [J]" in example.latex()


def test_files_keep_every_digit(example, tmp_path):
    for path, write in example.files(tmp_path / "out"):
        write(path)
    found = pd.read_csv(tmp_path / "out" / "moves.csv")
    assert found["energy [J]"][0] == 0.0236835
    assert (tmp_path / "out" / "front.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "out" / "report.md").read_text() == example.markdown()


def test_a_table_that_is_too_wide_becomes_several(tmp_path):
    wide = pd.DataFrame([{f"the figure {k} [J]": f"within {k} mm" for k in range(12)}])
    (tmp_path / "wide.md").write_text("# Wide\n\n{{ tables.wide | table }}\n")
    console = Console(width=80, file=StringIO())
    show(console, Report(tmp_path / "wide.md", tables={"wide": wide}))
    text = console.file.getvalue()
    assert all(f"the figure {k} [J]" in text and f"within {k} mm" in text for k in range(12))
    assert max(len(line.rstrip()) for line in text.splitlines()) <= 80
    # the first column names the rows of each: 11 others, 3 beside it
    assert text.count("the figure 0 [J]") == 4


def test_terminal_shows_the_table_without_pictures(example):
    console = Console(width=60, file=StringIO())
    show(console, example)
    show_facts(console, [("energy", "0.0237 J")])
    text = console.file.getvalue()
    assert re.search(r"epsilon +- +5", text)
    assert "front.png" not in text
    assert re.search(r"energy +0.0237 J", text)
