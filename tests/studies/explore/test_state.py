"""What the page shows of a move that is changed by hand, without the page."""

import math

import numpy as np
import pytest
from quietarm.models import DualLinkManipulator, SingleLinkManipulator, known_plants
from quietarm.ocp import (
    CycloidPolynomial,
    InfeasibleTaskError,
    Plan,
    PointToPoint,
    epsilon_front,
    evaluate_coefficients,
    evaluate_robustness,
    plan_move,
)
from quietarm.studies.cli import main
from quietarm.studies.explore.drawn import film, panels, robustness_curves
from quietarm.studies.explore.opening import menu, of_file, of_plant
from quietarm.studies.explore.state import FILES
from quietarm.studies.sweep.library import MoveLibrary

LINK = SingleLinkManipulator()
TASK = PointToPoint(LINK, math.pi / 6, 0.8)


@pytest.fixture(scope="module")
def begun():
    return of_plant(LINK)


def test_it_begins_with_the_plain_cycloid_of_the_papers_first_move(begun):
    assert begun.task == TASK
    assert begun.plan.energy == pytest.approx(evaluate_coefficients(TASK, []).energy, rel=1e-9)
    assert begun.shown["target"] == 30.0
    assert begun.shown["torque_limit"] is None


def test_what_is_set_is_what_is_evaluated(begun):
    now = begun.changed({"target": 45.0, "duration": 0.9, "a2": -0.2, "deflection_limit": 60.0})
    task = PointToPoint(LINK, math.pi / 4, 0.9, deflection_limit=0.06)
    assert now.task == task
    assert now.plan.motion == evaluate_coefficients(task, [0, -0.2, 0, 0, 0, 0]).motion
    assert now.changed({"deflection_limit": None}).task.limits == {}


@pytest.mark.parametrize(
    ("name", "given", "held"),
    [
        ("target", 999.0, 360.0),
        ("start", -1e9, -360.0),
        ("duration", 0.0, 0.1),
        ("duration", None, 0.1),
        ("torque_limit", -5.0, 1e-3),
        ("residual_limit", -1.0, 0.0),
        ("bound", 1e9, 1e4),
        ("a1", 3.0, 1.0),
    ],
)
def test_values_outside_their_range_are_held(begun, name, given, held):
    assert begun.changed({name: given}).shown[name] == pytest.approx(held)


def test_a_move_that_is_none_is_refused_with_its_remedy(begun):
    with pytest.raises(ValueError, match="there is no move; change one of them"):
        begun.changed({"target": 0.0})
    with pytest.raises(InfeasibleTaskError, match="feasible with the rest kept: torque limit"):
        begun.changed({"torque_limit": 0.01}).solved()


def test_the_answer_is_the_gradients(begun):
    limited = begun.changed({"acceleration_limit": 40.0, "residual_limit": 1.0, "bound": 0.3})
    task = PointToPoint(LINK, math.pi / 6, 0.8, acceleration_limit=40.0)
    assert limited.solved().plan == plan_move(task, residual_limit=1e-3, bound=0.3)


def test_coefficients_beyond_the_sliders_widen_them(begun):
    solved = begun.solved()
    furthest = max(map(abs, solved.plan.coefficients))
    assert begun.dials["a6"].most == 1.0 < furthest <= solved.dials["a6"].most
    assert solved.changed({"a6": 0.0}).dials["a6"].most == solved.dials["a6"].most


def test_a_point_of_the_front_is_picked_and_another_move_has_none(begun):
    told = []
    now = begun.changed({"bound": 0.2}).with_front(lambda *counts: told.append(counts))
    assert told[-1] == (20, 20)
    point = now.front.points[7]
    picked = now.picked(7)
    assert picked.plan.coefficients == point.coefficients
    assert picked.plan.energy == pytest.approx(point.energy, rel=1e-9)
    assert (picked.of_front, picked.plain().of_front) == (True, False)
    assert picked.plain().plan.coefficients == (0.0,) * 6
    assert picked.changed({"a1": 0.1}).front is now.front
    assert picked.changed({"duration": 0.9}).front is None
    assert picked.changed({"bound": None}).front is None


def test_another_plant_keeps_the_move(begun):
    now = begun.changed({"target": 40.0, "a1": 0.1}).of_plant(DualLinkManipulator())
    assert (now.task.plant, now.shown["target"]) == (DualLinkManipulator(), 40.0)
    assert now.plan.coefficients[0] == 0.1


def test_the_menu_has_the_plant_in_hand_and_all_others():
    heavy = SingleLinkManipulator(omega=9.0)
    plants = menu(heavy, known_plants())
    assert next(iter(plants.values())) == heavy
    assert {"single-link with omega = 9 rad/s", "single-link", "dual-link"} <= plants.keys()


def test_the_panels_have_the_motion_its_cycloid_and_limits_that_are_near(begun):
    now = begun.changed({"torque_limit": 0.3, "speed_limit": 50.0})
    drawn = panels(now)
    dashes = [curve.dash for curve in drawn["torque"]]
    assert dashes == ["solid", "solid", "dashed", "dashed", "dotted"]
    assert [curve.dash for curve in drawn["speed"]] == ["solid", "solid", "dotted"]  # far off
    assert drawn["speed"][-1].x == [0.8, 0.8]  # the arrival
    motion = drawn["deflection"][1]
    assert max(map(abs, motion.y)) == pytest.approx(1e3 * now.plan.motion.peak_deflection, rel=1e-2)
    assert drawn["angle"][1].y[-1] == pytest.approx(30.0)


def test_the_robustness_is_that_of_the_motion(begun):
    curve, tolerated = robustness_curves(begun)
    own = evaluate_robustness(TASK, CycloidPolynomial(), np.zeros(6), {"frequency": 0.2}, samples=1)
    assert curve.y == pytest.approx(1e3 * own.sweeps[0].figures.residual, rel=1e-3)
    assert tolerated.y == pytest.approx([1e3 * own.tolerated] * 2, rel=1e-3)


def test_the_structure_moves_from_start_to_rest(begun):
    seen = film(begun.solved().plan)
    link = np.array([seen.xs[0], seen.ys[0]]).reshape(2, seen.frames, -1)
    length = 0.475  # section 3.1
    assert link[:, 0, -1] == pytest.approx([length, 0.0], abs=1e-4)
    assert link[:, -1, -1] == pytest.approx(length * np.array([0.75**0.5, 0.5]), abs=1e-4)


def test_files_are_those_of_the_command_line(begun, tmp_path):
    files = {name: begun.file(name) for name in FILES}
    (tmp_path / "plan.json").write_text(files["plan.json"])
    assert Plan.load(tmp_path / "plan.json") == begun.plan
    assert files["move.csv"].startswith("time_s,angle_rad,speed_rad_s,")
    assert '#include "move.h"' in files["move.c"]
    assert "void move_at(double time" in files["move.h"]


def test_a_plan_and_a_front_are_opened_with_what_they_were_asked_for(tmp_path):
    plan = plan_move(TASK, residual_limit=1e-3, bound=0.3)
    plan.save(tmp_path / "plan.json")
    opened = of_file(tmp_path / "plan.json")
    assert (opened.plan, opened.residual_limit, opened.bound) == (plan, 1e-3, 0.3)
    front = epsilon_front(TASK, bound=0.2, points=4)
    front.save(tmp_path / "front.json")
    opened = of_file(tmp_path / "front.json")
    assert (opened.front, opened.bound) == (front, 0.2)
    assert opened.plan.coefficients == front.points[0].coefficients


def test_moves_of_a_sweep_are_looked_up_within_its_grid(tmp_path):
    place = tmp_path / "moves.zarr"
    axes = "--target 20deg:50deg:10deg --set omega=9,10,11,12"
    with pytest.raises(SystemExit) as ended:
        main([*f"sweep single-link {axes} --duration 0.9 --quiet --output".split(), str(place)])
    assert ended.value.code == 0
    opened = of_file(place)
    assert (opened.shown["target"], opened.shown["omega"]) == (40.0, 11.0)
    now = opened.changed({"target": 33.0, "omega": 99.0, "torque_limit": 5.0})
    assert now.shown["omega"] == 12.0
    assert now.task.limits == {"torque": 5.0}
    found = MoveLibrary(place).plan(target=math.radians(33.0), omega=12.0)
    assert now.plan.coefficients == pytest.approx(found.coefficients, abs=1e-12)
    assert now.changed({"a1": 0.0}).plan.coefficients[0] == 0.0  # by hand
