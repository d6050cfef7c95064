"""Questions and answers of the page alive, without its server and without a browser."""

import json
import re
from math import pi

import numpy as np
import pytest
from robots import straight, ur5_with_bar

from quietarm.models import SingleLinkManipulator
from quietarm.models.dimensions import SECOND, TIP, Words
from quietarm.ocp import (
    InfeasibleTaskError,
    Plan,
    PointToPoint,
    Quantity,
    Uncertainty,
    add_quantity,
    epsilon_front,
    evaluate_coefficients,
    remove_quantity,
)
from quietarm.studies.reproduce.paper import paper_points
from quietarm.views.explore.by_hand import MoveByHand, open_plant
from quietarm.views.explore.live_page import LivePage
from quietarm.views.page.samples import unpacked
from quietarm.views.page.trade_off import trade_off

LINK = SingleLinkManipulator()
TASK = PointToPoint(LINK, pi / 6, 0.8)


@pytest.fixture(scope="module")
def page():
    return LivePage(open_plant(LINK), paper_points)


def ask(page, what, report=lambda done, total: None, **question):
    answer = page.answer(what, json.dumps(question).encode(), report)
    return json.loads(json.dumps(answer, allow_nan=False))


def data_of(html):
    """The numbers that are in a page, as a browser reads them."""
    (text,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', html)
    return json.loads(text)


def test_a_motion_is_that_of_cvodes_with_every_quantity_over_time(page):
    coefficients = {"a1": 0.01, "a2": -0.12, "a3": 0, "a4": 0, "a5": 0, "a6": 0}
    answer = ask(page, "motion", values={"duration": 0.9, "torque_limit": 0.3, **coefficients})
    task = PointToPoint(LINK, pi / 6, 0.9, torque_limit=0.3)
    plan = evaluate_coefficients(task, [*coefficients.values()])
    (point,) = answer["move"]["points"]
    assert (point["residual"], point["energy"]) == (plan.residual, plan.energy)
    drawn = ["deflection", "torque", "power", "angle", "speed", "acceleration", "jerk"]
    assert list(answer["move"]["panels"]) == drawn
    speeds = unpacked(answer["move"]["panels"]["speed"]["values"])[0, 0]
    assert np.abs(speeds).max() == pytest.approx(plan.motion.peak_speed, rel=0.01)
    # a limit that a motion comes near stands in its panel
    assert answer["move"]["panels"]["torque"]["limits"] == [[-0.3, 0.3]]
    assert answer["fields"]["shown"]["a2"] == -0.12


def test_a_motion_that_is_none_is_refused_in_a_sentence(page):
    with pytest.raises(ValueError, match="there is no move; change one of them"):
        ask(page, "motion", values={"target": 0.0})
    with pytest.raises(InfeasibleTaskError, match="feasible with all else unchanged"):
        ask(page, "motion", values={"torque_limit": 0.01}, optimal=True)
    for body in (b"", b"{", b"[]", b'{"values": 1}', b'{"values": {"a1": NaN}}', b'{"more": 1}'):
        with pytest.raises(ValueError, match="the page asks what is no question"):
            page.answer("motion", body, lambda done, total: None)


def test_the_gradients_motion_is_found_and_its_file_loads(page, tmp_path):
    answer = ask(page, "motion", optimal=True)
    assert answer["move"]["points"][0]["energy"] == pytest.approx(0.0237, abs=5e-5)  # README
    rows = dict(ask(page, "rows", optimal=True)["rows"])
    assert rows["status"] == "The solver found a local optimum."
    assert "enter what the drive can do under Limits" in rows["peak jerk"]
    file = ask(page, "plan.json", optimal=True)
    (tmp_path / file["name"]).write_text(file["text"])
    plan = Plan.load(tmp_path / "plan.json")
    assert plan.energy == answer["move"]["points"][0]["energy"]
    assert plan.status.solved
    begins = {"move.csv": "time_s,", "move.c": "/* move: ", "move.h": "/* move: "}
    for name, begin in begins.items():
        assert ask(page, name, optimal=True)["text"].startswith(begin)


def test_a_front_is_traced_and_each_of_its_points_is_asked_by_its_number(page):
    told = []
    answer = ask(page, "front", lambda *counts: told.append(counts), values={"bound": 0.2})
    assert told[-1] == (20, 20)
    front = answer["front"]
    assert [beside["label"] for beside in front["beside"]] == ["the paper's best (6 terms)"]
    assert len(front["points"]) == len(front["coefficients"]) > 10
    told.clear()
    picked = ask(page, "plan.json", lambda *counts: told.append(counts),
                 values={"bound": 0.2}, point=5)  # fmt: skip
    assert told == []  # it is not traced again
    assert json.loads(picked["text"])["coefficients"] == pytest.approx(
        front["coefficients"][5], abs=1e-12
    )
    rows = dict(ask(page, "rows", values={"bound": 0.2}, point=5)["rows"])
    assert rows["status"] == "a point of the front"
    with pytest.raises(ValueError, match="the front has no point 99"):
        ask(page, "rows", values={"bound": 0.2}, point=99)


def test_a_file_of_a_front_is_dragged_at_once():
    front = epsilon_front(TASK, bound=0.2, points=4)
    first = front.points[0].coefficients
    opened = MoveByHand(TASK, front.profile, first, bound=0.2).pick(front, first)
    data = data_of(LivePage(opened).html())
    assert [place["residual"] for place in data["alive"]["front"]["points"]] == [
        point.residual for point in front.points
    ]


def test_the_residual_over_the_error_of_the_frequency(page):
    answer = ask(page, "robustness", optimal=True)["robustness"]
    errors, residuals = np.array(answer["errors"]), np.array(answer["residuals"])
    assert (errors[0], errors[-1], answer["unit"]) == (-20.0, 20.0, "mm")
    assert residuals[errors == 0.0] < 1e-3
    # 5 % of the 77 mm that the plain cycloid leaves (docs/start.md)
    assert answer["tolerated"] == pytest.approx(3.85, abs=0.01)
    assert residuals[-1] > answer["tolerated"]


def test_the_page_by_itself_has_no_sliders(page):
    alive = page.html()
    assert set(data_of(alive)["alive"]["plants"]) >= {"single-link", "dual-link"}
    assert 'id="hand"' in alive
    file = trade_off(evaluate_coefficients(TASK, [0.0, -0.1])).html()
    assert "alive" not in data_of(file)
    assert 'id="hand"' not in file
    assert "fetch(" not in file


def test_of_an_uncertain_task_the_colour_is_green_and_the_plant_is_in_the_menu():
    task = PointToPoint(LINK, pi / 6, 0.8, uncertainty=Uncertainty({"frequency": 0.08}))
    page = LivePage(MoveByHand.of_plan(evaluate_coefficients(task, [0.01, -0.17])))
    data = data_of(page.html())
    assert data["moves"][0]["this"] == "robust-plan"
    assert data["alive"]["fields"]["shown"]["plant"] in data["alive"]["plants"]


@pytest.mark.slow
def test_a_plan_of_a_robot_has_its_duration_set_and_all_its_joints_over_time():
    task = PointToPoint(ur5_with_bar().along(straight()), 1.0, 1.0)
    page = LivePage(MoveByHand.of_plan(evaluate_coefficients(task, [0.01, -0.12])))
    answer = ask(page, "motion", values={"duration": 1.2})
    # a path has a start and a target of its own
    moves = [dial["name"] for dial in answer["fields"]["dials"] if dial["group"] == "move"]
    assert moves == ["duration"]
    assert answer["move"]["duration"] == 1.2
    for name in ("torque", "angle", "speed"):
        assert answer["move"]["panels"][name]["names"] == list(task.plant.joint_names)
    # the robot's tables reach from -16 to +14 % of the frequency
    assert ask(page, "robustness")["robustness"]["errors"][-1] == 10.0


def test_a_quantity_of_a_users_own_has_its_panel_and_its_dial():
    add_quantity(
        Quantity("tip_haste", TIP / SECOND, Words("tip haste"), lambda sample: sample.tip_speeds)
    )
    try:
        answer = ask(LivePage(open_plant(LINK)), "motion", values={"tip_haste_limit": 0.5})
        panel = answer["move"]["panels"]["tip_haste"]
        assert panel["limits"] == [[-0.5, 0.5]]
        assert answer["fields"]["shown"]["tip_haste_limit"] == 0.5
    finally:
        remove_quantity("tip_haste")
