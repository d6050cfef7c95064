"""The tables and the picture of a comparison."""

from functools import partial

import numpy as np
import pytest
import quietarm.studies.comparison.measures
import quietarm.studies.reading.saved
import quietarm.studies.reports.comparison
from quietarm.studies.comparison.tables import tables
from quietarm.studies.document.files import table_in_markdown
from quietarm.studies.figures.comparison import (
    BANDS,
    comparison_figure,
)
from quietarm.studies.paper import ARM_HALF, paper_points

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


def test_the_picture_holds_floor_and_papers_points(front_of):
    task = ARM_HALF.task
    fronts = [front_of([(0, 0.2), (5, 0.1)], m, task=task, terms=6) for m in ("nsga2", "vepso")]
    (point,) = paper_points(task, {6})
    # docs/physics.md: 0.1492 J for Table 4, N = 6, with a_5 mended
    assert point.energy == pytest.approx(0.1492, rel=1e-3)
    for axis in comparison_figure(compare(fronts, floor=0.09), [point]).axes[:2]:
        np.testing.assert_allclose(
            drawn(axis, "paper, N = 6"), [[point.residual * 1e3, 0.1492]], rtol=1e-3
        )
        assert set(drawn(axis, "floor: any joint motion, at rest")[:, 1]) == {0.09}
