"""Motions in panels, with their limits."""

import dataclasses
import math
from typing import NamedTuple

import numpy as np
import pytest
from matplotlib.text import Text
from several_joints import TwoLinks

from quietarm.ocp import PointToPoint, Uncertainty, evaluate_coefficients
from quietarm.views.pictures import Line, Panel, draw_quantity, drawn_quantities, motion_figure
from quietarm.views.report.words import move_of


@pytest.fixture(scope="module")
def figure(plan):
    return motion_figure(plan, "A title")


class Drawn(NamedTuple):
    """A motion of a panel: what is opaque before arrival and lighter after it, in one."""

    label: str
    times: np.ndarray
    values: np.ndarray


def motions(axis):
    """The drawn motions of a panel, without its arrival mark and limits."""
    pieces = [line for line in axis.get_lines() if len(line.get_xdata()) > 2]
    return [
        Drawn(
            before.get_label(),
            np.append(before.get_xdata(), after.get_xdata()[1:]),
            np.append(before.get_ydata(), after.get_ydata()[1:]),
        )
        for before, after in zip(pieces[::2], pieces[1::2], strict=True)
    ]


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
        assert [motion.label for motion in motions(axis)] == ["plain cycloid", "this plan"]
    tips = [motion.values for motion in motions(figure.axes[3])]
    times = motions(figure.axes[3])[0].times
    after = times >= plan.task.duration
    # In millimetres; 2.28 * 33.82 mm is the ringing in docs/physics.md's table.
    assert np.abs(tips[0][after]).max() == pytest.approx(2.28 * 33.82, rel=1e-3)
    assert np.abs(tips[1][after]).max() < 1e-3
    assert cycloid.residual == pytest.approx(np.abs(tips[0][after]).max() * 1e-3, rel=1e-3)


def test_panels_hold_what_they_name(figure, plan):
    drawn = [motions(axis)[1] for axis in panels(figure)]
    times = drawn[0].times
    on_the_way = times <= plan.task.duration
    angle, speed, acceleration, tip, torque = (motion.values for motion in drawn)
    path = plan.path
    np.testing.assert_allclose(angle[on_the_way], path(times[on_the_way]), atol=1e-9)
    np.testing.assert_allclose(speed[on_the_way], path(times[on_the_way], 1), atol=1e-9)
    np.testing.assert_allclose(acceleration[on_the_way], path(times[on_the_way], 2), atol=1e-9)
    assert np.abs(tip[on_the_way]).max() == pytest.approx(
        plan.motion.peak_deflection * 1e3, rel=1e-3
    )
    assert np.abs(torque[on_the_way]).max() == pytest.approx(plan.motion.peak_torque, rel=1e-3)


def test_a_picture_says_what_its_motions_take_and_leave_and_how_that_is_verified(
    task, plan, cycloid
):
    head = motion_figure(plan).get_suptitle()
    said, facts = head.splitlines()
    assert said == (
        f"This plan takes {plan.energy:.3g} J and arrives at rest; the plain cycloid takes "
        f"{cycloid.energy:.3g} J and leaves {1e3 * cycloid.residual:.3g} mm"
    )
    assert facts == "single-link, 0 to 30 deg in 0.8 s; checked by a second integrator"
    several = [Line(cycloid, f"motion {i}") for i in range(4)]
    best = f"Motion 0 leaves 77.1 mm for {cycloid.energy:.3g} J, the stillest and cheapest of 4"
    assert motion_figure(several).get_suptitle().startswith(best)
    robust = dataclasses.replace(task, uncertainty=Uncertainty({"frequency": 0.05}))
    assert "in the worst case" not in head
    assert "with frequency ±5 %" in motion_figure(
        evaluate_coefficients(robust, [0.0, -0.1])
    ).get_suptitle().replace("\n", " ")
    assert motion_figure(plan, "").get_suptitle() == ""


@pytest.mark.parametrize(
    ("target", "shown"),
    [
        (math.pi / 6, "0 to 30 deg"),
        (0.5236, "0 to 30 deg"),  # as it is typed: 30.00007 deg
        (math.radians(0.0123456), "0 to 0.012346 deg"),
        (math.radians(123.456), "0 to 123.46 deg"),
    ],
)
def test_angles_have_no_dust_of_rounding(task, target, shown):
    move = dataclasses.replace(task, start=0.0, target=target)
    assert move_of(move) == f"{shown} in 0.8 s"
    back = dataclasses.replace(task, start=target, target=-1e-17)
    assert move_of(back) == f"{shown.split()[2]} to 0 deg in 0.8 s"


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
    found = {name: limits(draw_quantity(drawn, name)) for name in drawn_quantities()}
    assert {name: at for name, at in found.items() if at} == {
        name: pytest.approx(at) for name, at in shown.items()
    }


def test_a_limit_is_drawn_until_the_arrival(task):
    # what holds the joint of a swinging link may be more than the limit of the move
    motion = evaluate_coefficients(dataclasses.replace(task, torque_limit=0.3), [])
    drawn = draw_quantity([Line(motion, "cycloid")], "torque").get_lines()
    dotted = [list(line.get_xdata()) for line in drawn if line.get_linestyle() == ":"]
    assert dotted == [[0.0, task.duration]] * 2


@pytest.mark.slow
def test_the_titles_of_joints_side_by_side_stay_apart_and_the_head_is_as_wide_as_all():
    plan = evaluate_coefficients(PointToPoint(TwoLinks(), 1.0, 0.8), [0.01, -0.1])
    figure = motion_figure(plan)
    figure.draw_without_rendering()
    titles = {axis.get_title(loc="left") for axis in figure.axes} - {""}
    texts = [text for text in figure.findobj(Text) if text.get_text() in titles]
    drawn = [text.get_window_extent() for text in texts]
    assert len(drawn) >= 4
    assert not any(
        one.overlaps(two) for place, one in enumerate(drawn) for two in drawn[place + 1 :]
    )
    sentence = figure.get_suptitle().split("\n")[0]
    assert len(sentence) > 60  # in one line, where a phone has room for 46 letters


def test_a_panel_of_the_users_is_checked(task, what_is_made_up_is_forgotten):
    plan = evaluate_coefficients(task, [])
    with pytest.raises(ValueError, match="panel mine has no title; give one, as title = "):
        type("Mine", (Panel,), {"name": "mine"})
    with pytest.raises(ValueError, match=r"panel mine draws nothing; define values\(self"):
        type("Mine", (Panel,), {"name": "mine", "title": "a"})
    with pytest.raises(ValueError, match="unknown quantity 'mine'"):
        draw_quantity(plan, "mine")
    mine = {"name": "mine", "title": "a", "values": lambda self, motion: [1.0]}
    kinds = [type("Mine", (Panel,), mine)]  # a class that nobody holds is gone
    times = len(plan.trajectory.time)
    with pytest.raises(
        ValueError, match=rf"panel mine has values of shape \(1,\) at {times} times"
    ):
        draw_quantity(plan, "mine")
    kinds.append(type("Mine", (Panel,), mine | {"name": "torque"}))
    with pytest.raises(ValueError, match="name 'torque' of Mine is that of a panel of quietarm's"):
        motion_figure(plan)


def test_a_panel_of_several_curves_x(what_is_made_up_is_forgotten):
    class Powers(Panel):
        name = "powers"
        title = "power of each joint [W]"

        def values(self, motion):
            powers = motion.trajectory.sample.powers
            return dict(zip(motion.task.plant.joint_names, powers, strict=True))

    plan = evaluate_coefficients(PointToPoint(TwoLinks(), 1.0, 1.0), [])
    names = plan.task.plant.joint_names
    assert len(names) == 2
    labels = draw_quantity([Line(plan, "cycloid")], "powers").get_legend_handles_labels()[1]
    assert labels == [f"cycloid, {name}" for name in names]
    figure = motion_figure([Line(plan, "cycloid")], quantities=["angle", "power", "powers"])
    titles = [ax.get_title(loc="left") for ax in figure.axes]
    assert titles.count("power of each joint [W]") == titles.count("power [W]") == 1
