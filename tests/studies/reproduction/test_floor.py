"""Multiples of the floor: what `quietarm reproduce` holds against it."""

import csv
import dataclasses
import io

import pytest
from quietarm.studies.document.files import table_in_markdown
from quietarm.studies.paper import ARM_HALF, CONDITIONS, ROWS
from quietarm.studies.reproduction.pictures import floor_dots
from quietarm.studies.reproduction.tables import finding, floor_table, multiples

TERMS = (2, 4, 6, 8, 10)
PAPER, IN_BOX, FREE = "paper", "gradient, in the box", "gradient, no box"


def medians(reproduction, condition):
    return {place: middle for place, (middle, _, _) in multiples(reproduction, condition).items()}


@pytest.mark.parametrize("condition", CONDITIONS, ids=lambda c: f"{c.task.plant.name} {c.label}")
def test_nothing_is_below_the_floor(reproduction, condition):
    # Not the gradient, nor anything within the paper's residuals (which are nearly rest).
    found = multiples(reproduction, condition)
    assert min(lower for _, lower, _ in found.values()) > 1
    gradient = [middle for (series, _), (middle, _, _) in found.items() if series == FREE]
    assert gradient[-1] < 1.3  # ten terms are near it: docs/physics.md, 'N = 8 and 10 go lower'
    assert gradient == sorted(gradient, reverse=True)


def test_the_table_has_a_row_a_condition_and_csv_all_of_it(reproduction):
    table = floor_table(reproduction)
    rows = list(csv.DictReader(io.StringIO(table.csv())))
    assert [(row["plant"], row["move"]) for row in rows] == [
        (c.task.plant.name, c.label) for c in CONDITIONS
    ]
    for row, condition in zip(rows, CONDITIONS, strict=True):
        floor = reproduction.floors[condition]
        assert float(row["floor_J"]) == floor.energy
        assert float(row["left_J"]) == floor.left
        assert row["starts_that_agree"] == f"{floor.agreeing()} of {len(floor.starts)}"
        found = medians(reproduction, condition)
        assert float(row["gradient_no_box_10_terms_over_floor"]) == found[FREE, 10]
        assert float(row["paper_6_terms_over_floor"]) == found[PAPER, 6]
        assert bool(row["paper_2_terms_over_floor"]) == ((PAPER, 2) in found)


def test_the_finding_follows_from_the_multiples(reproduction):
    paper = [
        row.energy / reproduction.floors[row.condition].energy for row in ROWS
    ]  # its least and its most
    assert f"{min(paper):.2f} to {max(paper):.2f} times" in finding(reproduction)
    halved = {c: _with_energy(f, f.energy / 2) for c, f in reproduction.floors.items()}
    changed = finding(dataclasses.replace(reproduction, floors=halved))
    assert f"{2 * min(paper):.2f} to {2 * max(paper):.2f} times" in changed


def _with_energy(floor, energy):
    return dataclasses.replace(floor, motion=dataclasses.replace(floor.motion, energy=energy))


def test_a_search_that_met_no_residual_is_left_out(reproduction):
    def never_so_still(row):
        stiller = {m: dataclasses.replace(of, level=1e-12) for m, of in row.searched.items()}
        return dataclasses.replace(row, searched=stiller)

    rows = tuple(map(never_so_still, reproduction.rows))
    without = dataclasses.replace(reproduction, rows=rows)
    series = {series for series, _ in multiples(without, ARM_HALF)}
    assert series == {PAPER, IN_BOX, FREE}
    assert "VEPSO" not in table_in_markdown(floor_table(without))


def test_the_dots_stand_where_the_multiples_are(reproduction):
    axis = floor_dots(reproduction).axes[0]
    dots = sorted(
        float(line.get_xdata()[0]) for line in axis.get_lines() if line.get_marker() == "o"
    )
    found = [item for c in CONDITIONS for item in medians(reproduction, c).items()]
    expected = sorted(middle - 1 for _, middle in found)
    assert dots == pytest.approx(expected)
    numbers = sorted(int(text.get_text()) for text in axis.texts)
    assert numbers == sorted(terms for (_, terms), _ in found)
    # The axis is marked in multiples: a tick that says 2 stands where the distance above is 1.
    ticks = {
        float(label.get_text()): place
        for label, place in zip(axis.get_xticklabels(), axis.get_xticks(), strict=True)
    }
    for multiple, place in ticks.items():
        assert place == pytest.approx(multiple - 1)
    assert 2.0 in ticks
    low, high = axis.get_xlim()
    assert low < min(dots)
    assert max(dots) < high
