"""What the page shows of a move that is changed by hand, without the page."""

import math

import pytest
from bokeh.document import Document

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
from quietarm.studies.cli import main
from quietarm.studies.explore.move import Explored
from quietarm.studies.explore.page import Page
from quietarm.studies.explore.start_page import menu, open_file, open_plant
from quietarm.studies.sweep.library import MoveLibrary

LINK = SingleLinkManipulator()
TASK = PointToPoint(LINK, math.pi / 6, 0.8)


@pytest.fixture(scope="module")
def begun():
    return open_plant(LINK)


def test_it_begins_with_the_papers_first_move_and_what_is_set_is_evaluated(begun):
    assert (begun.task, begun.plan.coefficients) == (TASK, (0.0,) * 6)
    assert (begun.shown["target"], begun.shown["torque_limit"]) == (30.0, None)
    now = begun.change({"target": 45.0, "duration": 0.9, "a2": -0.2, "deflection_limit": 60.0})
    task = PointToPoint(LINK, math.pi / 4, 0.9, deflection_limit=0.06)
    assert now.task == task
    assert now.plan.motion == evaluate_coefficients(task, [0, -0.2, 0, 0, 0, 0]).motion
    assert now.change({"deflection_limit": None}).task.limits == ()


@pytest.mark.slow
def test_fields_that_are_set_within_a_moment_are_one_change(begun):
    document = Document()
    Page(document, begun, menu(LINK))
    for title, angle in {"start [deg]": 30.0, "target [deg]": 0.0}.items():
        document.select_one({"title": title}).value = angle
    (gathered,) = document.session_callbacks
    gathered.callback()
    # with the first alone there would be no move, from 30 to 30 deg
    assert "single-link, 30 to 0 deg" in document.select_one({"name": "figures"}).text


def test_values_outside_their_range_are_held(begun):
    now = begun.change({"target": 999.0, "duration": 0.0, "torque_limit": -5.0, "a1": None})
    assert (now.shown["target"], now.shown["duration"], now.shown["a1"]) == (360, 0.1, 0)
    assert now.shown["torque_limit"] == pytest.approx(1e-3)


def test_sliders_of_coefficients_span_the_box_and_what_is_beyond_it(begun):
    # eqs (12) and (17): 0.2 of the link, 0.5 of the arm
    assert (begun.dials["a1"].least, begun.dials["a1"].most) == (-0.2, 0.2)
    assert open_plant(ArmOnFlexibleLink()).dials["a1"].most == 0.5
    wider = begun.change({"bound": 0.4})
    assert wider.dials["a1"].most == 0.4
    assert wider.change({"bound": None}).dials["a1"].most == 0.2
    planned = begun.solve()
    for name, value in planned.coefficients.items():
        assert max(0.2, 1.02 * abs(value)) <= planned.dials[name].most
        assert planned.dials[name].most < max(0.2, 1.02 * abs(value)) + 0.1
    assert planned.dials["a6"].most > 1.0  # of the README's plan, which has no box
    assert planned.dials["a1"].most == 0.2
    # no coefficient begins at an end of its slider
    at_the_end = Explored(evaluate_coefficients(TASK, [0.0, 0.2, -0.3]), bound=0.2)
    assert at_the_end.reach == (0.2, 0.3, 0.4)
    # it stays while coefficients are changed: else a slider would go under the pointer
    assert planned.change({"a1": 0.0, "a2": 0.0}).reach == planned.reach


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
    task = PointToPoint(LinearAxis(), target, duration)
    begun = Explored(evaluate_coefficients(task, [0.0], profile=CycloidPolynomial(1)))
    now = begun.change({"target": 1500.0, "duration": 2.0})
    assert (now.task.target, now.task.duration) == (1.5, 2.0)
    assert now.change({"target": 9999.0}).task.target == furthest
    assert now.change({"target": 100.0}).dials == begun.dials


def test_a_move_that_is_none_is_refused_with_its_remedy(begun):
    with pytest.raises(ValueError, match="there is no move"):
        begun.change({"target": 0.0})
    with pytest.raises(InfeasibleTaskError, match="feasible with all else unchanged: torque limit"):
        begun.change({"torque_limit": 0.01}).solve()


def test_a_point_of_the_front_is_picked_and_another_move_has_none(begun):
    told = []
    now = begun.change({"bound": 0.2}).find_front(lambda *counts: told.append(counts))
    assert told[-1] == (20, 20)
    point = now.front.points[7]
    picked = now.pick(7)
    assert picked.plan.coefficients == point.coefficients
    assert picked.plan.energy == pytest.approx(point.energy, rel=1e-9)
    assert (picked.of_front, picked.begin_again().of_front) == (True, False)
    assert picked.begin_again().plan.coefficients == (0.0,) * 6
    assert picked.change({"a1": 0.1}).front is now.front
    assert picked.change({"duration": 0.9}).front is None
    assert picked.change({"bound": None}).front is None


def test_another_profile_begins_from_its_plain_motion_and_terms_are_refused_by_name(begun):
    now = begun.keep().choose_profile("spline", 8)
    assert (now.profile, len(now.coefficients), now.kept) == ("spline", 8, begun.plan)
    assert now.plan.coefficients == tuple(CycloidSpline(8).plain)
    assert begun.choose_profile("polynomial", 4).plan.profile == CycloidPolynomial(4)
    assert begun.keep().keep().kept is None
    with pytest.raises(ValueError, match="give a whole number from 4 up"):
        now.choose_profile("spline", 2)


def test_a_plan_and_a_front_are_opened_with_what_they_were_asked_for(tmp_path):
    plan = plan_move(TASK, residual_limit=1e-3, bound=0.3)
    plan.save(tmp_path / "plan.json")
    opened = open_file(tmp_path / "plan.json")
    assert (opened.plan, opened.residual_limit, opened.bound) == (plan, 1e-3, 0.3)
    front = epsilon_front(TASK, bound=0.2, points=4)
    front.save(tmp_path / "front.json")
    opened = open_file(tmp_path / "front.json")
    assert (opened.front, opened.bound) == (front, 0.2)
    assert opened.plan.coefficients == front.points[0].coefficients


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
    assert now.plan.coefficients == pytest.approx(found.coefficients, abs=1e-12)
    assert now.change({"a1": 0.0}).plan.coefficients[0] == 0.0  # by hand
