"""The tables and the picture of a comparison."""

import csv
from functools import partial

import numpy as np
import pytest
import quietarm.studies.comparison.measures
import quietarm.studies.reading.saved
import quietarm.studies.reports.comparison
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from quietarm.models import ArmOnFlexibleLink
from quietarm.ocp import PointToPoint
from quietarm.studies.comparison.tables import runs_table, tables
from quietarm.studies.document.files import table_in_markdown
from quietarm.studies.figures.comparison import (
    BANDS,
    PANELS,
    comparison_figure,
    looks,
    panel_figure,
)
from quietarm.studies.paper import ARM_HALF, SINGLE_LINK_HALF_1_0, condition_of, paper_points

compare = partial(quietarm.studies.comparison.measures.compare_fronts, fill=0)


@pytest.fixture
def seeds(front_of):
    """Three runs of NSGA-II."""
    return [front_of([(1, e), (5, e - 0.2)], seed=s) for s, e in enumerate((0.95, 0.97, 0.96))]


@pytest.fixture
def comparison(good, poor, seeds):
    return compare([good, *seeds], floor=0.3)


# Tables


def cells(table):
    """A table as a dict: row heading to its cells."""
    lines = [line.strip("| ").split(" | ") for line in table_in_markdown(table).splitlines()[2:]]
    return {name.strip(): rest for name, *rest in lines if "---" not in name}


def test_tables_show_the_figures_of_the_comparison(comparison):
    shown = tables(comparison)
    fronts, energies = cells(shown["fronts"]), cells(shown["energies"])
    assert fronts["method"] == ["epsilon constraint", "NSGA-II"]
    assert fronts["seeds"] == ["1", "3"]
    # as found, points of an exact front would lose by steps that the front has not
    volume = comparison.groups[1].spread("hypervolume").median
    assert fronts["hypervolume (more is better)"] == ["-", f"{volume:.4f}"]
    assert energies["energy at 0.1 mm [J]"] == ["0.8", "not reached"]
    assert energies["energy at 1 mm [J]"] == ["0.8", "0.96"]
    assert energies["above the best at 1 mm [%]"] == ["0.00", "20.00"]


def test_a_run_a_row_with_every_digit(comparison):
    rows = list(csv.DictReader(runs_table(comparison).csv().splitlines()))
    assert [row["seed"] for row in rows] == ["", "0", "1", "2"]
    for row, run in zip(rows, comparison.runs, strict=True):
        assert float(row["igd_plus"]) == run.igd_plus
        assert float(row["gap_at_1mm"]) == run.gaps[1]
        assert row["complete"] == "yes"
    assert rows[1]["energy_J_at_0.1mm"] == ""


# Pictures


def drawn(axis, label):
    """Points of the line of a label."""
    (line,) = [line for line in axis.get_lines() if line.get_label() == label]
    return np.column_stack([np.asarray(line.get_xdata()), np.asarray(line.get_ydata())])


def test_the_picture_holds_the_fronts_as_staircases(comparison):
    picture = comparison_figure(comparison)
    whole, still, gaps, _ = picture.axes
    stairs = drawn(whole, "epsilon constraint")
    np.testing.assert_allclose(stairs[:3], [[0, 0.8], [4, 0.5], [8, 0.4]])
    (line,) = [line for line in whole.get_lines() if line.get_label() == "epsilon constraint"]
    assert line.get_drawstyle() == "steps-post"
    np.testing.assert_allclose(drawn(whole, "NSGA-II")[[0, 1]], [[1, 0.96], [5, 0.76]])
    (band,) = whole.collections
    heights = band.get_paths()[0].vertices[:, 1]
    assert (heights.min(), heights.max()) == (0.75, 0.97)
    assert still.get_xscale() == gaps.get_xscale() == "log"
    assert picture.axes[3].get_legend().get_title().get_text() == BANDS


def test_points_are_held_against_the_best_within_their_residual(comparison):
    axis = comparison_figure(comparison).axes[2]
    np.testing.assert_allclose(
        drawn(axis, "NSGA-II"), [[1, 100 * (0.96 / 0.8 - 1)], [5, 100 * (0.76 / 0.5 - 1)]]
    )
    assert set(drawn(axis, "epsilon constraint")[:, 1]) == {0}


def test_the_picture_holds_floor_and_papers_points(front_of):
    task = ARM_HALF.task
    fronts = [front_of([(0, 0.2), (5, 0.1)], m, task=task, terms=6) for m in ("nsga2", "vepso")]
    fronts[1] = front_of([(1, 0.3)], "vepso", task=task, terms=6)
    (point,) = paper_points(task, {6})
    # docs/physics.md: 0.1492 J for Table 4, N = 6, with a_5 mended
    assert point.energy == pytest.approx(0.1492, rel=1e-3)
    figure = comparison_figure(compare(fronts, floor=0.09), [point])
    for axis in figure.axes[:2]:
        np.testing.assert_allclose(
            drawn(axis, "paper, N = 6"), [[point.residual * 1e3, 0.1492]], rtol=1e-3
        )
        assert set(drawn(axis, "floor: any joint motion, at rest")[:, 1]) == {0.09}
        low, high = axis.get_ylim()
        assert low < 0.09 < point.energy < high
    (legend,) = [axis.get_legend() for axis in figure.axes if axis.get_legend()]
    assert [text.get_text() for text in legend.get_texts()] == [
        "NSGA-II", "VEPSO", "paper, N = 6", "floor: any joint motion, at rest"
    ]  # fmt: skip


def test_where_the_paper_prints_no_coefficients_its_energy_is_known(task):
    (point,) = paper_points(SINGLE_LINK_HALF_1_0.task, {6})
    assert (point.energy, point.residual) == (0.296, None)  # Table 3
    assert paper_points(SINGLE_LINK_HALF_1_0.task, {3}) == []
    assert paper_points(PointToPoint(ArmOnFlexibleLink(), 1.0, 1.0), {6}) == []
    assert condition_of(task).label == "0 to pi/6, 0.8 s"


def test_every_group_has_a_look_of_its_own(front_of):
    methods = ["epsilon", "nsga2", "vepso", "weighted", "nsga2, polished", "other", "another"]
    fronts = [front_of([(1, 0.5)], method) for method in methods]
    fronts += [front_of([(2, 0.5)], "nsga2", bound=bound) for bound in (0.3, 0.4, 0.5)]
    found = list(looks(compare(fronts)).values())
    assert len({(look.colour, look.dash) for look in found}) == 10  # in the panels of lines
    assert len({(look.colour, look.mark) for look in found}) == 10  # and in that of points
    of_eight = looks(compare(fronts[:8])).values()
    assert len({to_rgba(look.colour) for look in of_eight}) == 8


@pytest.mark.parametrize("panel", PANELS)
def test_a_panel_stands_alone_with_its_legend(comparison, panel):
    figure = panel_figure(comparison, panel)
    assert len(figure.axes) == 1
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[:2] == ["epsilon constraint", "NSGA-II"]


def heights_within(axis):
    """The heights of what a panel shows, where it shows it."""
    (left, right), (low, high) = axis.get_xlim(), axis.get_ylim()
    shown = [drawn(axis, label) for label in axis.get_legend_handles_labels()[1]]
    table = np.vstack([points[points[:, 0] > 0] for points in shown])
    inside = (left <= table[:, 0]) & (table[:, 0] <= right)
    return table[inside & (low <= table[:, 1]) & (table[:, 1] <= high), 1]


def test_the_still_end_is_shown_where_a_search_is_cheap_because_it_rings(good, front_of):
    """A tight limit: the search begins at 6 mm, with less than half the still motion's energy."""
    whole, still, _ = comparison_figure(compare([good, front_of([(6, 0.3), (9, 0.2)])])).axes[:3]
    for axis in (whole, still):
        assert axis.get_ylim()[1] > 0.8  # of `good` at rest
        assert 0.5 in heights_within(axis)  # of `good` at 4 mm


def test_the_still_end_is_where_the_stillest_are(front_of):
    """Nothing arrives within 5 mm, the largest of the residuals that energies are compared at."""
    fronts = [front_of([(16, 0.5), (40, 0.2)], "epsilon"), front_of([(20, 0.4)])]
    _, still, gaps, _ = comparison_figure(compare(fronts)).axes
    assert {0.5, 0.4} <= set(heights_within(still))
    assert still.get_xlim()[0] == gaps.get_xlim()[0] == pytest.approx(0.9 * 16)
    still.figure.draw_without_rendering()
    labels = [label for label in still.get_xticklabels() if label.get_text()]
    low, high = still.get_xlim()
    assert sum(low <= label.get_position()[0] <= high for label in labels) >= 1


@pytest.mark.parametrize("draw", PANELS.values())
def test_a_panel_is_drawn_on_the_axes_that_are_given_or_on_new_ones(comparison, draw):
    given = Figure().subplots()
    assert draw(comparison, ax=given) is given
    assert given.get_lines()
    assert draw(comparison).figure is not given.figure
