"""Tables read the same on screen, in Markdown and in CSV."""

import csv
import io
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from quietarm.studies.report.markdown import table_in_markdown
from quietarm.studies.report.table import Column, Table
from quietarm.studies.report.terminal import show_table
from rich.console import Console

TABLE = Table(
    "Two moves",
    [Column("move"), Column("terms N"), Column("F2 [J]"), Column("time [s]", "{:.2f}".format)],
    [["0 to pi/6, 0.8 s", 2, 0.062973456789, 0.5], ["a|b", 6, None, 1.0]],
)


def on_screen(table, width=80):
    console = Console(file=io.StringIO(), width=width)
    show_table(console, table)
    return console.file.getvalue()


def test_markdown_stands_upright_with_the_moves_beside_each_other():
    assert table_in_markdown(TABLE) == (
        "**Two moves**\n"
        "\n"
        "| move | 0 to pi/6, 0.8 s | a/b |\n"  # a bar would end the cell
        "| --- | ---: | ---: |\n"
        "| terms N | 2 | 6 |\n"
        "| F2 [J] | 0.06297 | - |\n"
        "| time [s] | 0.50 | 1.00 |"
    )


def test_screen_shows_the_same_cells_as_markdown():
    lines = on_screen(TABLE).splitlines()
    assert lines[0].rstrip() == "Two moves"
    shown = [line.split() for line in lines if line.startswith("  terms N")]
    assert shown == [["terms", "N", "2", "6"]]
    energies = [line.split() for line in lines if "F2" in line]
    assert energies == [["F2", "[J]", "0.06297", "-"]]


def test_screen_fits_a_narrow_terminal_without_cutting_a_figure():
    text = on_screen(TABLE, width=50)
    assert max(map(len, text.splitlines())) <= 50
    assert "…" not in text
    assert "0.06297" in text


def test_a_narrow_terminal_keeps_a_number_and_its_unit_on_one_line():
    names = [["one"], ["other"], ["third"]]
    rows = [[*name, 9.211, "5 of 31", 35.25] for name in names]
    percent = "{:.3g} %".format
    columns = [Column("method"), Column("hypervolume missing", percent),
               Column("runs with at most 1 % missing"), Column("energy", percent)]  # fmt: skip
    console = Console(width=50, file=io.StringIO())
    show_table(console, Table("What they ended with", columns, rows))
    lines = console.file.getvalue().splitlines()
    assert max(map(len, lines)) <= 50
    assert sum(line.count("9.21 %") for line in lines) == 3
    assert sum(line.count("5 of 31") for line in lines) == 3
    assert sum(line.count("35.2 %") for line in lines) == 3


def test_csv_has_a_row_a_line_and_every_digit():
    rows = list(csv.reader(io.StringIO(TABLE.csv())))
    assert rows == [
        ["move", "terms N", "F2 [J]", "time [s]"],
        ["0 to pi/6, 0.8 s", "2", "0.062973456789", "0.5"],
        ["a|b", "6", "", "1.0"],
    ]


@given(st.lists(st.floats(allow_nan=False), min_size=1, max_size=5))
def test_csv_numbers_come_back_exactly(numbers):
    table = Table("t", [Column("x")] * len(numbers), [numbers])
    _, row = csv.reader(io.StringIO(table.csv()))
    assert [float(cell) for cell in row] == numbers


@pytest.mark.parametrize(
    ("cell", "text"),
    [(None, "-"), (3, "3"), ("N = 6", "N = 6"), (math.pi, "3.142"), (1e-9, "1e-09"), (0.0, "0")],
)
def test_cells_for_people(cell, text):
    assert Column("x").text(cell) == text


def test_a_column_may_write_its_numbers_its_own_way_and_leaves_counts_alone():
    column = Column("time [s]", "{:.1f}".format)
    assert (column.text(2.0), column.text(2)) == ("2.0", "2")


def test_csv_may_have_shorter_names():
    table = Table("t", [Column("move", key="move"), Column("F2 [J]", key="energy_J")], [["a", 1.0]])
    assert table.csv() == "move,energy_J\na,1.0\n"
    assert "| F2 [J] | 1 |" in table_in_markdown(table)


def test_a_quantity_that_no_row_has_is_left_out_for_people_and_kept_in_csv():
    table = Table("t", [Column("move"), Column("F2 [J]"), Column("x")], [["a", None, 1], ["b"] * 3])
    assert "F2 [J]" in table_in_markdown(table)
    table = Table("t", table.columns, [["a", None, 1], ["b", None, 2]])
    assert "F2 [J]" not in table_in_markdown(table)
    assert "F2 [J]" not in on_screen(table)
    assert table.csv() == "move,F2 [J],x\na,,1\nb,,2\n"


def test_a_unit_in_brackets_is_no_markup():
    table = Table("t", [Column("move"), Column("power [bold]")], [["a [red]", 2]])
    assert "power [bold]" in on_screen(table)
    assert "a [red]" in on_screen(table)


def test_a_table_without_rows_still_names_its_columns():
    assert Table("none", TABLE.columns, []).csv() == "move,terms N,F2 [J],time [s]\n"


@pytest.mark.parametrize("width", [60, 80, 200])
def test_a_table_too_wide_for_the_screen_stands_in_pieces(width):
    """No figure is cut, and every row stands once."""
    rows = [[f"method {i}", 0.123456 + i, f"{i}.00001"] for i in range(8)]
    table = Table("Wide", [Column("method"), Column("energy within 1 mm [J]"), Column("c")], rows)
    console = Console(file=io.StringIO(), width=width)
    show_table(console, table)
    text = console.file.getvalue()
    assert "\u2026" not in text
    assert [text.count(f"{i}.00001") for i in range(8)] == [1] * 8
    assert max(len(line.rstrip()) for line in text.splitlines()) <= width
    assert text.count("Wide") == {60: 3, 80: 2, 200: 1}[width]
