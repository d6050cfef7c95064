"""Tables read the same on screen, in Markdown and in CSV."""

import csv
import io

import pytest
from hypothesis import given
from hypothesis import strategies as st
from quietarm.studies.document.files import table_in_markdown
from quietarm.studies.document.table import Column, Table
from quietarm.studies.document.terminal import show_table
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


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=1, max_size=5))
def test_csv_numbers_come_back_exactly(numbers):
    table = Table("t", [Column("x")] * len(numbers), [numbers])
    _, row = csv.reader(io.StringIO(table.csv()))
    assert [float(cell) for cell in row] == numbers


def test_a_quantity_that_no_row_has_is_left_out_for_people_and_kept_in_csv():
    table = Table("t", [Column("move"), Column("F2 [J]"), Column("x")], [["a", None, 1], ["b"] * 3])
    assert "F2 [J]" in table_in_markdown(table)
    table = Table("t", table.columns, [["a", None, 1], ["b", None, 2]])
    assert "F2 [J]" not in table_in_markdown(table)
    assert "F2 [J]" not in on_screen(table)
    assert table.csv() == "move,F2 [J],x\na,,1\nb,,2\n"


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
