"""Motions in panels, with their limits."""

import dataclasses

import numpy as np
import pytest

from quietarm.ocp import evaluate_coefficients
from quietarm.studies.figures import QUANTITIES_DRAWN, Line, draw_quantity, motion_figure


@pytest.fixture(scope="module")
def figure(plan):
    return motion_figure(plan, "A title")


def motions(axis):
    """The drawn motions of a panel, without its arrival mark and limits."""
    return [line for line in axis.get_lines() if len(line.get_xdata()) > 2]


def panels(figure):
    """The axes that something is drawn in; the last may hold the legend."""
    return [axis for axis in figure.axes if axis.get_lines()]


def legend(figure):
    """The texts of its one legend."""
    (found,) = [*figure.legends, *filter(None, (axis.get_legend() for axis in figure.axes))]
    return [text.get_text() for text in found.get_texts()]


def test_a_plan_alone_is_drawn_over_the_plain_cycloid_of_its_task(figure, plan, cycloid):
    assert legend(figure) == ["plain cycloid", "this plan"]
    for axis in panels(figure):
        assert [line.get_label() for line in motions(axis)] == ["plain cycloid", "this plan"]
    tips = [line.get_ydata() for line in motions(figure.axes[3])]
    times = motions(figure.axes[3])[0].get_xdata()
    after = times >= plan.task.duration
    # In millimetres; 2.28 * 33.82 mm is the ringing in docs/physics.md's table.
    assert np.abs(tips[0][after]).max() == pytest.approx(2.28 * 33.82, rel=1e-3)
    assert np.abs(tips[1][after]).max() < 1e-3
    assert cycloid.residual == pytest.approx(np.abs(tips[0][after]).max() * 1e-3, rel=1e-3)


def test_panels_hold_what_they_name(figure, plan):
    drawn = [motions(axis)[1] for axis in panels(figure)]
    times = np.asarray(drawn[0].get_xdata())
    on_the_way = times <= plan.task.duration
    angle, speed, acceleration, tip, torque = (np.asarray(line.get_ydata()) for line in drawn)
    path = plan.path
    np.testing.assert_allclose(angle[on_the_way], path(times[on_the_way]), atol=1e-9)
    np.testing.assert_allclose(speed[on_the_way], path(times[on_the_way], 1), atol=1e-9)
    np.testing.assert_allclose(acceleration[on_the_way], path(times[on_the_way], 2), atol=1e-9)
    assert np.abs(tip[on_the_way]).max() == pytest.approx(
        plan.motion.peak_deflection * 1e3, rel=1e-3
    )
    assert np.abs(torque[on_the_way]).max() == pytest.approx(plan.motion.peak_torque, rel=1e-3)


# Limits


def limits(axis):
    """The heights of the limits that a panel shows."""
    return sorted(
        line.get_ydata()[0]
        for line in axis.get_lines()
        if line.get_linestyle() == ":" and len(line.get_xdata()) == 2
    )


@pytest.mark.parametrize(
    ("limit", "shown"),
    [
        ({"torque_limit": 0.3}, {"torque": [-0.3, 0.3]}),
        ({"speed_limit": 1.4}, {"speed": [1.4]}),
        ({"torque_limit": 1e3}, {}),
    ],
)
def test_limits_are_lines_where_a_motion_comes_near_them(task, limit, shown):
    motion = evaluate_coefficients(dataclasses.replace(task, **limit), [])
    drawn = [Line(motion, "cycloid")]
    found = {name: limits(draw_quantity(drawn, name)) for name in QUANTITIES_DRAWN}
    assert {name: at for name, at in found.items() if at} == {
        name: pytest.approx(at) for name, at in shown.items()
    }
