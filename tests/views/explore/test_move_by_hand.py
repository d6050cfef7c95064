"""A move that is changed by hand, without the page."""

import math

import pytest

from quietarm.models import ArmOnFlexibleLink, LinearAxis, SingleLinkManipulator
from quietarm.ocp import (
    CycloidPolynomial,
    CycloidSpline,
    InfeasibleTaskError,
    PointToPoint,
    epsilon_front,
    evaluate_coefficients,
    plan_move,
)
from quietarm.studies.answers.open_by_hand import open_file
from quietarm.studies.cli import main
from quietarm.studies.sweep.library import MoveLibrary
from quietarm.views.explore.by_hand import MoveByHand, Question, menu, open_plant

LINK = SingleLinkManipulator()
TASK = PointToPoint(LINK, math.pi / 6, 0.8)


def by_hand(task, coefficients, **more):
    return MoveByHand.of_plan(evaluate_coefficients(task, coefficients), **more)


@pytest.fixture(scope="module")
def begun():
    return open_plant(LINK)


def test_it_begins_with_the_papers_first_move_and_what_is_set_is_evaluated(begun):
    assert (begun.task, tuple(begun.coefficients)) == (TASK, (0.0,) * 6)
    assert (begun.shown["target"], begun.shown["torque_limit"]) == (30.0, None)
    now = begun.change({"target": 45.0, "duration": 0.9, "a2": -0.2, "deflection_limit": 60.0})
    task = PointToPoint(LINK, math.pi / 4, 0.9, deflection_limit=0.06)
    assert now.task == task
    assert now.motion.motion == evaluate_coefficients(task, [0, -0.2, 0, 0, 0, 0]).motion
    assert now.change({"deflection_limit": None}).task.limits == ()


def test_what_is_set_together_is_one_change(begun):
    # with the first alone there would be no move, from 30 to 30 deg
    assert begun.change({"start": 30.0, "target": 0.0}).task.ends == "30 to 0 deg"


def test_values_outside_their_range_are_held(begun):
    now = begun.change({"target": 999.0, "duration": 0.0, "torque_limit": -5.0, "a1": None})
    assert (now.shown["target"], now.shown["duration"], now.shown["a1"]) == (360, 0.1, 0)
    assert now.shown["torque_limit"] == pytest.approx(1e-3)
    # a coefficient that is typed goes beyond its slider, which then grows
    assert begun.change({"a1": 5.0}).shown["a1"] == 5.0
    assert begun.change({"a1": 1e9}).shown["a1"] == 100.0


def test_sliders_of_coefficients_span_the_box_and_what_is_beyond_it(begun):
    # eqs (12) and (17): 0.2 of the link, 0.5 of the arm
    assert (begun.dials["a1"].least, begun.dials["a1"].most) == (-0.2, 0.2)
    assert open_plant(ArmOnFlexibleLink()).dials["a1"].most == 0.5
    assert begun.change({"bound": 0.4}).dials["a1"].most == 0.4
    planned = begun.solve()
    for name, value in zip(planned.coefficient_names, planned.coefficients, strict=True):
        assert max(0.2, 1.02 * abs(value)) <= planned.dials[name].most
        assert planned.dials[name].most < max(0.2, 1.02 * abs(value)) + 0.1
    assert planned.dials["a6"].most > 1.0  # of the README's plan, which has no box
    assert planned.dials["a1"].most == 0.2
    # no coefficient begins at an end of its slider
    ends = [dial.most for dial in by_hand(TASK, [0.0, 0.2, -0.3], bound=0.2).dials.values()]
    assert ends[3:6] == [0.2, 0.3, 0.4]


def test_a_linear_axis_is_set_in_millimetres_and_newtons():
    axis = LinearAxis()
    now = open_plant(axis).change({"target": 250.0, "torque_limit": 90.0, "deflection_limit": 4.0})
    assert now.task == PointToPoint(axis, 0.25, 0.8, torque_limit=90.0, deflection_limit=0.004)
    labels = [now.dials[name].label for name in ("target", "torque_limit", "speed_limit")]
    assert labels == ["target [mm]", "force [N]", "speed [m/s]"]
    assert now.dials["acceleration_limit"].label == "acceleration [m/s\u00b2]"
    assert all(plant.joint == "linear" for plant in menu(axis).values())


@pytest.mark.parametrize(("target", "duration", "furthest"), [(0.3, 0.8, 2.0), (4.0, 9.0, 4.0)])
def test_the_sliders_keep_their_ranges_while_the_move_is_changed(target, duration, furthest):
    begun = by_hand(PointToPoint(LinearAxis(), target, duration), [0.0])
    now = begun.change({"target": 1500.0, "duration": 2.0})
    assert (now.task.target, now.task.duration) == (1.5, 2.0)
    assert now.change({"target": 9999.0}).task.target == furthest
    assert now.change({"target": 100.0}).dials == begun.dials


def test_a_move_that_is_none_is_refused_with_its_remedy(begun):
    with pytest.raises(ValueError, match="there is no move"):
        begun.change({"target": 0.0})
    with pytest.raises(InfeasibleTaskError, match="feasible with all else unchanged: torque limit"):
        begun.change({"torque_limit": 0.01}).solve()


def test_a_front_is_of_its_move_alone(begun):
    told = []
    front = begun.change({"bound": 0.2}).find_front(lambda *counts: told.append(counts))
    assert told[-1] == (20, 20)
    point = front.points[7]
    picked = begun.change({"bound": 0.2}).pick(front, point.coefficients)
    assert tuple(picked.coefficients) == point.coefficients
    assert picked.motion.energy == pytest.approx(point.energy, rel=1e-9)
    assert (picked.is_of_front, begun.is_of_front) == (True, False)
    by_its_hand = picked.change({"a1": 0.1})
    assert (by_its_hand.front, by_its_hand.is_of_front) == (front, False)
    assert picked.change({"duration": 0.9}).front is None
    assert picked.change({"bound": None}).front is None


def test_another_profile_begins_from_its_plain_motion_and_terms_are_refused_by_name(begun):
    now = begun.choose_profile("spline", 8)
    assert (now.family, len(now.coefficient_names)) == ("spline", 8)
    assert tuple(now.coefficients) == tuple(CycloidSpline(8).plain)
    assert begun.choose_profile("polynomial", 4).profile == CycloidPolynomial(4)
    with pytest.raises(ValueError, match="give a whole number from 4 up"):
        now.choose_profile("spline", 2)
    # a request has bounded work
    with pytest.raises(ValueError, match="give at most 60"):
        now.choose_profile("spline", 10**9)


def test_a_question_is_asked_of_the_move_of_the_start(begun):
    plants = menu(LINK)
    asked = begun.asked(Question(plant="dual-link", profile="spline", terms=6), plants)
    assert asked.task.plant == plants["dual-link"]
    assert asked.profile == CycloidSpline(6)
    assert begun.asked(Question(plant="single-link"), plants) is begun
    for question, words in (
        (Question(plant="dual-lnk"), "did you mean 'dual-link'"),
        (Question(values={"a7": 1.0}), "unknown number 'a7'"),
        (Question(profile="spine"), "spine"),
    ):
        with pytest.raises(ValueError, match=words):
            begun.asked(question, plants)


def test_a_plan_and_a_front_are_opened_with_what_they_were_asked_for(tmp_path):
    plan = plan_move(TASK, residual_limit=1e-3, bound=0.3)
    plan.save(tmp_path / "plan.json")
    opened = open_file(tmp_path / "plan.json")
    assert (opened.motion, opened.residual_limit, opened.bound) == (plan, 1e-3, 0.3)
    front = epsilon_front(TASK, bound=0.2, points=4)
    front.save(tmp_path / "front.json")
    opened = open_file(tmp_path / "front.json")
    assert (opened.front, opened.bound) == (front, 0.2)
    assert opened.motion.coefficients == front.points[0].coefficients


@pytest.mark.slow
def test_moves_of_a_sweep_are_looked_up_within_its_grid(tmp_path):
    place = tmp_path / "moves.zarr"
    axes = "--target 20deg:50deg:10deg --set omega=9,10,11,12"
    with pytest.raises(SystemExit) as ended:
        main([*f"sweep single-link {axes} --duration 0.9 --quiet --output".split(), str(place)])
    assert ended.value.code == 0
    opened = open_file(place)
    assert (opened.shown["target"], opened.shown["omega"]) == (40.0, 11.0)
    now = opened.change({"target": 33.0, "omega": 99.0, "torque_limit": 5.0})
    assert now.shown["omega"] == 12.0
    assert [str(one) for one in now.task.limits] == ["torque 5 N m"]
    found = MoveLibrary(place).plan(target=math.radians(33.0), omega=12.0)
    assert now.motion.coefficients == pytest.approx(found.coefficients, abs=1e-12)
    held = dict.fromkeys(now.coefficient_names, 0.0)
    assert not any(opened.change({"target": 33.0, **held}).coefficients)  # by hand
    for change in (lambda: now.choose_plant(LINK), lambda: now.choose_profile("spline")):
        with pytest.raises(ValueError, match="the moves of a sweep have its"):
            change()
