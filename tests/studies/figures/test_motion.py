"""Motions in panels, with their limits; and pictures that are saved whole or not at all."""

import dataclasses

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from quietarm.ocp import PointToPoint, evaluate_coefficients
from quietarm.studies.display.pictures import SUFFIXES, save_figure
from quietarm.studies.figures import (
    PAPER_PANELS,
    QUANTITIES_DRAWN,
    RED,
    Line,
    draw_quantity,
    motion_figure,
)

TITLES = [
    "joint angle [rad]",
    "joint speed [rad/s]",
    "joint acceleration [rad/s²]",
    "tip displacement [mm]",
    "joint torque [N m]",
]
HEADS = {".png": b"\x89PNG\r\n\x1a\n", ".pdf": b"%PDF-", ".svg": b"<?xml"}
TAILS = {".png": b"IEND\xaeB`\x82", ".pdf": b"%%EOF\n", ".svg": b"</svg>\n"}


@pytest.fixture(scope="module")
def figure(plan):
    return motion_figure(plan, "A title")


@pytest.fixture
def picture():
    """The smallest one, for where it is not looked at."""
    drawn = Figure((1, 1))
    drawn.text(0, 0, "drawn")
    return drawn


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


def test_panels_name_their_quantity_with_its_unit(figure):
    named = [f"({letter}) {title}" for letter, title in zip("abcde", TITLES, strict=True)]
    assert [axis.get_title(loc="left") for axis in panels(figure)] == named
    assert figure.get_suptitle() == "A title"


def test_the_papers_panels_are_four_in_its_order(plan):
    figure = motion_figure(plan, quantities=PAPER_PANELS)
    # the order of the paper's Figs 2 and 5
    assert [axis.get_title(loc="left") for axis in figure.axes] == [
        f"({letter}) {TITLES[i]}" for letter, i in zip("abcd", (0, 1, 3, 4), strict=True)
    ]


def test_the_title_is_the_task_where_none_is_given(plan, task):
    limited = dataclasses.replace(task, torque_limit=0.2)
    words = "single-link, 0 to 30 deg in 0.8 s"
    assert motion_figure(plan).get_suptitle() == words
    figure = motion_figure([Line(evaluate_coefficients(limited, []), "cycloid")])
    assert figure.get_suptitle() == f"{words}, torque within 0.2 N m"
    assert motion_figure(plan, "").get_suptitle() == ""


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


@pytest.mark.parametrize("window", [0.3, 1.0])
def test_time_goes_on_through_the_residual_window(task, window):
    move = dataclasses.replace(task, residual_window=window)
    figure = motion_figure(evaluate_coefficients(move, []))
    for axis in panels(figure):
        for line in motions(axis):
            assert line.get_xdata()[0] == 0.0
            assert line.get_xdata()[-1] == pytest.approx(move.duration + window)
            assert move.duration in line.get_xdata()
        assert axis.get_xlim() == pytest.approx((0.0, move.duration + window))
    angle, speed = (motions(axis)[0] for axis in figure.axes[:2])
    after = np.asarray(angle.get_xdata()) > move.duration
    assert set(np.asarray(angle.get_ydata())[after]) == {move.target}
    assert set(np.asarray(speed.get_ydata())[after]) == {0.0}


def test_lines_keep_their_label_colour_and_style(plan, cycloid):
    figure = motion_figure([Line(cycloid, "first", "black"), Line(plan, "second", "tab:red", "--")])
    assert legend(figure) == ["first", "second"]
    for axis in panels(figure):
        first, second = motions(axis)
        assert (to_rgba(first.get_color()), first.get_linestyle()) == (to_rgba("black"), "-")
        assert (to_rgba(second.get_color()), second.get_linestyle()) == (to_rgba("tab:red"), "--")


def test_every_tip_of_a_plant_with_two_is_drawn_and_named(two_links):
    figure = motion_figure(evaluate_coefficients(PointToPoint(two_links, 1.5, 0.9), []))
    names = ["plain cycloid", "plain cycloid, tip 2", "this plan", "this plan, tip 2"]
    assert [line.get_label() for line in motions(figure.axes[3])] == names
    assert sorted(legend(figure)) == names
    assert [len(motions(axis)) for axis in panels(figure)] == [2, 2, 2, 4, 2]


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
        # the cycloid's peaks: 2 span / duration = 1.31 rad/s, 2 pi span / duration^2 = 5.14 rad/s^2
        ({"torque_limit": 0.3}, {"torque": [-0.3, 0.3]}),
        ({"acceleration_limit": 6.0}, {"acceleration": [-6.0, 6.0]}),
        ({"speed_limit": 1.4}, {"speed": [1.4]}),  # it never goes back
        ({"deflection_limit": 0.09}, {"deflection": [-90.0, 90.0]}),  # in millimetres, as drawn
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


def test_a_limit_far_off_is_told_and_does_not_flatten_the_motion(task):
    near, far = (
        draw_quantity(
            [Line(evaluate_coefficients(dataclasses.replace(task, torque_limit=limit), []), "it")],
            "torque",
        )
        for limit in (None, 1e3)
    )
    assert far.get_title(loc="left") == "joint torque [N m], limit 1000 far off"
    assert far.get_ylim() == near.get_ylim()


def test_the_jerk_is_drawn_where_a_task_limits_it(task):
    # the cycloid's largest: span (2 pi)^2 / duration^3 = 40.4 rad/s^3
    limited = evaluate_coefficients(dataclasses.replace(task, jerk_limit=50.0), [])
    titles = [axis.get_title(loc="left") for axis in panels(motion_figure([Line(limited, "it")]))]
    assert "(d) joint jerk [rad/s³]" in titles
    assert len(titles) == 6
    axis = draw_quantity([Line(limited, "it")], "jerk")
    assert limits(axis) == [-50.0, 50.0]
    assert np.max(motions(axis)[0].get_ydata()) == pytest.approx(40.37, rel=1e-3)


# Axes


def test_a_quantity_is_drawn_on_the_axes_that_are_given(plan):
    given = Figure().subplots()
    assert draw_quantity(plan, "torque", given) is given
    assert len(motions(given)) == 2
    own = draw_quantity(plan, "torque")
    assert own.figure is not given.figure
    for one, other in zip(motions(own), motions(given), strict=True):
        np.testing.assert_array_equal(one.get_ydata(), other.get_ydata())


def test_lines_without_a_colour_are_told_apart(plan, cycloid):
    axis = draw_quantity([Line(plan, "one"), Line(cycloid, "two"), Line(plan, "x", RED)], "speed")
    one, two, own = motions(axis)
    assert one.get_color() != two.get_color()
    assert one.get_linestyle() != two.get_linestyle()
    assert (own.get_color(), own.get_linestyle()) == (RED, "-")


def test_a_quantity_that_is_none_is_refused_and_the_others_named(plan):
    with pytest.raises(ValueError, match="no quantity is called 'power'; give one of angle, speed"):
        draw_quantity(plan, "power")


def test_motions_of_different_durations_are_refused(plan, task):
    longer = evaluate_coefficients(dataclasses.replace(task, duration=0.9), [])
    with pytest.raises(ValueError, match="all of one duration"):
        draw_quantity([Line(plan, "one"), Line(longer, "other")], "angle")
    with pytest.raises(ValueError, match="give one motion or more"):
        motion_figure([])


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_pictures_are_saved_whole(picture, tmp_path, suffix):
    path = tmp_path / f"move{suffix}"
    save_figure(picture, path)
    content = path.read_bytes()
    assert content.startswith(HEADS[suffix])
    assert content.endswith(TAILS[suffix])
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("name", ["move.txt", "move"])
def test_other_endings_are_refused_and_the_endings_named(picture, tmp_path, name):
    with pytest.raises(ValueError, match=r"is no picture; .* \.png, \.pdf, \.svg") as refused:
        save_figure(picture, tmp_path / name)
    assert str(tmp_path / name) in str(refused.value)
    assert list(tmp_path.iterdir()) == []
