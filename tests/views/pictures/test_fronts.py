"""Fronts on paper: what is drawn is what the fronts hold."""

import numpy as np
import pytest

from quietarm.ocp import FailedPoint, Mark
from quietarm.views.pictures import draw_fronts, front_figure


def history(*shares):
    return tuple(Mark(10 * (i + 1), share) for i, share in enumerate(shares))


@pytest.fixture
def fronts(front_of):
    """Energies at 1 mm of 0.25, 0.5 and 0.375 J, and one seed that is never as still."""
    found = {
        5: ([(0.1, 0.75), (1, 0.25), (9, 0.1)], (0.25, 0.5)),
        6: ([(0.5, 0.5), (1.01, 0.3)], (0.125, 0.75)),
        7: ([(0.9, 0.375)], (0.5, 0.625)),
        8: ([(2, 0.2), (3, 0.1)], (0.0, 1.0)),
    }
    return [
        front_of(points, "vepso", seed=seed, history=history(*shares))
        for seed, (points, shares) in found.items()
    ]


def test_each_front_is_drawn_point_by_point_and_named(fronts):
    left = front_figure(fronts).axes[0]
    for line, front in zip(left.lines, fronts, strict=True):
        np.testing.assert_allclose(line.get_xdata(), front.residuals * 1e3)
        np.testing.assert_array_equal(line.get_ydata(), front.energies)
        assert line.get_label() == f"seed {front.record.seed}"
        # the energy that a residual allows is that of the last point as still
        assert line.get_drawstyle() == "steps-post"
    assert left.get_legend() is not None


def test_of_one_front_the_knee_is_named_and_what_failed_is_counted(front_of):
    points, failed = [(0, 0.9), (1, 0.4), (9, 0.3)], FailedPoint({"residual_limit": 5e-3}, "none")
    front = front_of(points, "epsilon", seed=None, failures=(failed,), gaps=((2e-3, 6e-3),))
    (panel,) = front_figure([front]).axes
    assert legend(panel) == [
        "no weight reaches these", "gradient (epsilon constraint)", "1 not found",
        "stillest: 0.9 J at rest", "cheapest: 0.3 J at 9 mm", "knee: 0.4 J at 1 mm", "1 mm: 0.4 J"
    ]  # fmt: skip
    assert (
        front_figure([front])
        .get_suptitle()
        .replace("\n", " ")
        .startswith(
            "From 0.9 J at rest to 0.3 J with 9 mm: this vibration saves 66.7 % of the energy"
        )
    )
    line = panel.lines[0]
    assert line.get_drawstyle() == "default"
    assert np.isnan(line.get_xdata()).tolist() == [False, False, True, False]  # none over the gap


def legend(panel):
    return [text.get_text() for text in panel.get_legend().get_texts()]


def test_gaps_and_failures_of_all_fronts_are_named_once(front_of):
    failed = FailedPoint({"residual_limit": 5e-3}, "none")
    front = front_of(
        [(1, 0.4), (9, 0.3)], "weighted", seed=None, failures=(failed,), gaps=((2e-3, 6e-3),)
    )
    alone = ["no weight reaches these", "gradient (weighted sum)", "1 not found"]
    assert legend(draw_fronts([front])) == alone
    assert legend(front_figure([front]).axes[0])[:3] == alone
    both = ["no weight reaches these", "front 1", "front 2", "2 not found"]
    assert legend(draw_fronts([front, front])) == both
    with pytest.raises(ValueError, match="2 fronts have 1 labels; give each front one"):
        draw_fronts([front, front], labels=["coarse"])
    named = legend(draw_fronts([front, front], labels=np.array(["coarse", "fine"])))
    assert named[1:3] == ["coarse", "fine"]
    assert draw_fronts([front_of([(1, 0.4)])]).get_legend() is None  # the title says what it is


def test_the_hypervolume_is_drawn_with_its_quartiles(fronts):
    panel = front_figure(fronts).axes[1]
    table = [[g.hypervolume for g in front.history] for front in fronts]
    low, high = np.quantile(table, [0.25, 0.75], axis=0, method="inverted_cdf")
    middle = np.median(table, axis=0)
    (median,) = panel.lines
    np.testing.assert_array_equal(median.get_xdata(), [10, 20])
    np.testing.assert_array_equal(median.get_ydata(), middle)
    corners = panel.collections[0].get_paths()[0].vertices
    for x, lower, upper in zip([10, 20], low, high, strict=True):
        heights = corners[corners[:, 0] == x, 1]
        assert (heights.min(), heights.max()) == (lower, upper)
    # of 0.5, 0.625, 0.75 and 1
    assert panel.get_title("left") == "hypervolume: 0.6875 (0.5000 to 0.7500)"


def test_the_energy_of_each_seed_is_drawn_over_its_quartiles(fronts):
    panel = front_figure(fronts).axes[2]
    *seeds, median = panel.lines
    assert [line.get_marker() for line in seeds] == ["o", "s", "^", "x"]
    assert [line.get_ydata()[0] for line in seeds[:3]] == [0.25, 0.5, 0.375]
    # of 0.25, 0.375, 0.5 and one that never arrives
    np.testing.assert_array_equal(median.get_ydata(), 0.4375)
    assert panel.get_title("left") == "energy at 1 mm: 0.4375 J\n(0.25 to 0.5 J), 3 of 4 seeds"
