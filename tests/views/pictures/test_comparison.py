"""The tables and the picture of a comparison."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from quietarm.metaheuristics.score import gap
from quietarm.studies.compare import compare_fronts
from quietarm.studies.compare.front_report import methods_table
from quietarm.studies.reproduce.paper import ARM_HALF, paper_points
from quietarm.views.pictures import comparison_figure

compare = partial(compare_fronts, fill=0)


@pytest.fixture
def seeds(front_of):
    """Three runs of NSGA-II."""
    return [front_of([(1, e), (5, e - 0.2)], seed=s) for s, e in enumerate((0.95, 0.97, 0.96))]


@pytest.fixture
def comparison(good, poor, seeds):
    return replace(compare([good, *seeds]), floor=0.3)


# Tables


def test_tables_have_medians_and_say_what_is_not_reached(comparison):
    table = methods_table(comparison)
    assert table["method"].tolist() == ["epsilon constraint", "NSGA-II"]
    assert table["seeds"].tolist() == [1, 3]
    # as found, points of the gradient would lose by steps that its front has not
    gaps = [gap(run.scores["hypervolume"]) for run in comparison.groups[1].runs]
    assert table["hypervolume gap [%]"].isna().tolist() == [True, False]
    assert table["hypervolume gap [%]"][1].startswith(f"{np.median(gaps):.2g} (")
    assert table["energy [J] within 0.1 mm"].tolist() == ["0.8", "none"]
    assert table["energy [J] within 1 mm"].tolist() == ["0.8", "0.96 (0.95 to 0.97)"]


# Pictures


def drawn(axis, label):
    """Points of the line of a label."""
    (line,) = [line for line in axis.get_lines() if line.get_label() == label]
    return np.column_stack([np.asarray(line.get_xdata()), np.asarray(line.get_ydata())])


def test_the_picture_holds_the_fronts_as_staircases(comparison):
    picture = comparison_figure(comparison)
    whole, still, gaps, _ = picture.axes
    stairs = drawn(whole, "gradient (epsilon constraint)")
    np.testing.assert_allclose(stairs[:3], [[0, 0.8], [4, 0.5], [8, 0.4]])
    (line,) = [
        line for line in whole.get_lines() if line.get_label() == "gradient (epsilon constraint)"
    ]
    assert line.get_drawstyle() == "steps-post"
    np.testing.assert_allclose(drawn(whole, "search (NSGA-II)")[[0, 1]], [[1, 0.96], [5, 0.76]])
    (band,) = whole.collections
    heights = band.get_paths()[0].vertices[:, 1]
    assert (heights.min(), heights.max()) == (0.75, 0.97)
    assert still.get_xscale() == gaps.get_xscale() == "log"
    assert "best to worst" in picture.axes[3].get_legend().get_title().get_text()


def test_the_picture_holds_floor_and_papers_points(front_of):
    task = ARM_HALF.task
    fronts = [front_of([(0, 0.2), (5, 0.1)], m, task=task, terms=6) for m in ("nsga2", "vepso")]
    (point,) = paper_points(task, {6})
    # docs/physics.md: 0.1492 J for Table 4, N = 6, with a_5 mended
    assert point.energy == pytest.approx(0.1492, rel=1e-3)
    for axis in comparison_figure(replace(compare(fronts), floor=0.09), [point]).axes[:2]:
        np.testing.assert_allclose(
            drawn(axis, "the paper's best (6 terms)"), [[point.residual * 1e3, 0.1492]], rtol=1e-3
        )
        ((residual, energy),) = drawn(axis, "best without parametrisation, at rest")
        # where it is, at rest: on the left edge of both panels, and its figures stand beside it
        assert (residual, energy) == (axis.get_xlim()[0], 0.09)
        # of the stillest motion of both fronts, 0.2 J
        assert [text.get_text() for text in axis.texts] == ["0.09 J at rest,\n55 % less"]
