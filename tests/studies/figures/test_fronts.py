"""Fronts on paper: what is drawn is what the fronts hold."""

from itertools import pairwise

import numpy as np
import pytest
from matplotlib.figure import Figure
from quietarm.ocp import Generation
from quietarm.studies.display.pictures import save_figure
from quietarm.studies.figures import draw_fronts, draw_hypervolume, draw_seed_energies, front_figure


def history(*shares):
    return tuple(Generation(10 * (i + 1), share) for i, share in enumerate(shares))


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
        assert line.get_label() == f"seed {front.seed}"
        # the energy that a residual allows is that of the last point as still
        assert line.get_drawstyle() == "steps-post"
    assert left.get_legend() is not None


def test_the_hypervolume_is_drawn_with_its_quartiles(fronts):
    panel = front_figure(fronts).axes[1]
    table = [[g.hypervolume for g in front.history] for front in fronts]
    low, middle, high = np.quantile(table, [0.25, 0.5, 0.75], axis=0)
    (median,) = panel.lines
    np.testing.assert_array_equal(median.get_xdata(), [10, 20])
    np.testing.assert_array_equal(median.get_ydata(), middle)
    corners = panel.collections[0].get_paths()[0].vertices
    for x, lower, upper in zip([10, 20], low, high, strict=True):
        heights = corners[corners[:, 0] == x, 1]
        assert (heights.min(), heights.max()) == (lower, upper)
    # 0.5, 0.625, 0.75 and 1: by hand, with quartiles interpolated
    assert panel.get_title() == "hypervolume: 0.6875 (0.5938 to 0.8125)"


def test_the_energy_of_each_seed_is_drawn_over_its_quartiles(fronts):
    panel = front_figure(fronts).axes[2]
    *seeds, median = panel.lines
    assert [line.get_marker() for line in seeds] == ["o", "o", "o", "x"]
    assert [line.get_ydata()[0] for line in seeds[:3]] == [0.25, 0.5, 0.375]
    assert [line.get_xdata()[0] for line in seeds] == [0, 1, 2, 3]
    assert [label.get_text() for label in panel.get_xticklabels()] == ["5", "6", "7", "8"]
    # of 0.25, 0.375, 0.5 and one that never arrives
    np.testing.assert_array_equal(median.get_ydata(), 0.4375)
    assert not panel.patches  # the upper quartile falls on a seed that never arrives
    assert panel.get_title() == "energy at 1 mm: 0.4375 J\n3 of 4 seeds reach 1 mm"
    assert panel.get_xlabel() == "seed (x: never within 1 mm, line: median)"
    three = front_figure(fronts[:3]).axes[2]
    band = three.patches[0].get_extents().transformed(three.transData.inverted())
    assert (band.y0, band.y1) == pytest.approx((0.3125, 0.4375), rel=1e-12)
    assert three.get_title() == (
        "energy at 1 mm: 0.375 J (0.3125 to 0.4375)\n3 of 3 seeds reach 1 mm"
    )


def test_seeds_that_agree_are_not_drawn_as_if_they_did_not(front_of):
    fronts = [front_of([(0.5, 0.2 + 1e-6 * s)], seed=s, history=history(0.5)) for s in range(3)]
    low, high = front_figure(fronts).axes[2].get_ylim()
    assert (low + high) / 2 == pytest.approx(0.200001, rel=1e-9)
    assert high - low == pytest.approx(0.01 * 0.200001, rel=1e-9)


def test_one_seed_has_no_spread(fronts):
    figure = front_figure(fronts[:1], "title")
    front, volume = figure.axes
    assert front.get_legend() is None
    assert volume.get_title() == "hypervolume: 0.5000"
    assert figure.get_suptitle() == "title"


def test_interrupted_searches_are_drawn_but_counted_in_no_quartile(front_of, fronts):
    partial = front_of(
        [(0.1, 0.9)], "vepso", seed=9, history=history(0.1), complete=False
    )  # fmt: skip
    figure, without = front_figure([*fronts, partial]), front_figure(fronts)
    line = figure.axes[0].lines[-1]
    assert (line.get_label(), line.get_linestyle()) == ("seed 9, interrupted", "--")
    for panel, same in zip(figure.axes[1:], without.axes[1:], strict=True):
        assert panel.get_title() == same.get_title()
        assert len(panel.lines) == len(same.lines)


@pytest.mark.parametrize(
    ("residuals", "scale"),
    [
        ((1.0, 1.1), "linear"),
        ((1.0, 4.9), "linear"),
        ((1.0, 5.1), "log"),
        ((0.2, 9.0), "log"),
        ((0.3, 80.0), "log"),
        ((1e-6, 80.0), "log"),
        ((0.0, 80.0), "log"),  # rest is drawn at 0.001 mm
        ((2.0,), "linear"),
    ],
)
def test_labels_of_the_residual_stay_apart(front_of, residuals, scale):
    points = [(residual, 1 / (i + 1)) for i, residual in enumerate(residuals)]
    figure = front_figure([front_of(points, history=history(0.5))])
    axis = figure.axes[0]
    assert axis.get_xscale() == scale
    figure.draw_without_rendering()  # lays it out
    low, high = axis.get_xlim()
    boxes = [
        label.get_window_extent()
        for label in (*axis.get_xticklabels(), *axis.get_xticklabels(minor=True))
        if label.get_text() and low <= label.get_position()[0] <= high
    ]
    assert len(boxes) >= 2
    boxes.sort(key=lambda box: box.x0)
    assert all(left.x1 < right.x0 for left, right in pairwise(boxes))


def test_an_empty_front_is_drawn_as_one(front_of, tmp_path):
    figure = front_figure([front_of([])])
    assert [text.get_text() for text in figure.axes[0].texts] == ["no point"]
    save_figure(figure, tmp_path / "front.png")


def test_one_generation_is_a_mark_and_not_an_empty_panel(front_of):
    one = front_of([(1, 0.2)], history=history(0.5))
    (median,) = draw_hypervolume([one]).lines
    assert (list(median.get_xdata()), list(median.get_ydata())) == ([10], [0.5])
    assert median.get_marker() not in {"", "None", None}
    three = [front_of([(1, 0.2)], seed=s, history=history(h)) for s, h in enumerate((0.5, 0.6, 1))]
    panel = draw_hypervolume(three)
    assert panel.lines[0].get_marker() not in {"", "None", None}
    assert panel.collections  # the quartiles


@pytest.mark.parametrize("draw", [draw_fronts, draw_hypervolume, draw_seed_energies])
def test_a_panel_is_drawn_on_the_axes_that_are_given_or_on_new_ones(fronts, draw):
    given = Figure().subplots()
    assert draw(fronts, given) is given
    assert given.lines
    assert draw(fronts).figure is not given.figure


def test_fronts_of_several_methods_are_named_by_them(fronts, good):
    labels = [line.get_label() for line in draw_fronts([*fronts[:2], good]).lines]
    assert labels == ["VEPSO, seed 5", "VEPSO, seed 6", "epsilon constraint"]
