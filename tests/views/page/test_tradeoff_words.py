"""Words of the page to drag: its figures are the files', and no sentence reads the wrong way."""

import json
import math
import re
from dataclasses import dataclass, replace

import numpy as np
import pytest
from robots import straight, ur5_with_bar

from quietarm.models import (
    ArmOnFlexibleLink,
    DualLinkManipulator,
    LinearAxis,
    SingleLinkManipulator,
)
from quietarm.ocp import (
    FrontPoint,
    ModalState,
    PointToPoint,
    Uncertainty,
    epsilon_front,
    evaluate_coefficients,
    plan_move,
)
from quietarm.ocp.energy import Energy
from quietarm.studies.reproduce.paper import paper_points
from quietarm.views import trade_off
from quietarm.views.page.samples import unpacked
from quietarm.views.pictures.grammar import MEANINGS, OTHERS
from quietarm.views.report.method_rows import described


@dataclass(frozen=True)
class NoEnergy(Energy):
    """Energy of nothing, whatever the motion."""

    name = "none"


TASKS = {
    "link": lambda: PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8),
    "two links": lambda: PointToPoint(DualLinkManipulator(), math.pi / 6, 0.9),
    "arm": lambda: PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8),
    # docs/gallery.md: a crane's trolley of 6 m in 9 s
    "crane": lambda: PointToPoint(LinearAxis(omega1=1.566), 6.0, 9.0),
    "robot": lambda: PointToPoint(ur5_with_bar().along(straight()), 1.0, 1.0),
}


def four_digits(value):
    return pytest.approx(value, rel=6e-4)


@pytest.mark.slow_after(3)
@pytest.mark.parametrize("name", TASKS)
def test_every_figure_of_several_plans_is_the_motions_own(name):
    task = TASKS[name]()
    plans = {
        "first": evaluate_coefficients(task, [0.01, -0.12, -0.04, 0.12]),
        "second": evaluate_coefficients(task, [0.0, -0.08, 0.0, 0.05]),
    }
    (move,) = trade_off(plans).moves
    cycloid = evaluate_coefficients(task, [])
    motions = [plans[point["name"]] for point in move["points"]] + [cycloid]
    times = np.array(move["times"])
    moving = times <= task.duration
    joints = task.plant.joint_names
    for number, (place, plan) in enumerate(
        zip([*move["points"], move["cycloid"]], motions, strict=True)
    ):
        motion = plan.motion
        power = np.abs(plan.trajectory.power).max()
        expected = [
            1e3 * motion.residual, motion.energy, motion.peak_torque, power,
            1e3 * motion.peak_deflection,
        ]  # fmt: skip
        assert [float(cell) for cell in place["cells"]] == [four_digits(x) for x in expected]
        assert (place["residual"], place["energy"]) == (plan.residual, plan.energy)
        spot = [float(words.split()[0]) for words in place["spot"].split(", ")]
        assert spot == pytest.approx([1e3 * plan.residual, plan.energy], rel=6e-3)
        assert float(place["swing"].removeprefix("swings \u00b1").split()[0]) == spot[0]
        torques = unpacked(move["panels"]["torque"]["values"])[number]
        peaks = np.abs(torques[:, moving]).max(axis=1)
        # the curves are sampled such that they miss half a per cent of the peak of all
        assert peaks.max() == pytest.approx(motion.peak_torque, rel=0.03)
        several = len(joints) > 1
        assert place["notes"] == ["", "", joints[int(peaks.argmax())] if several else "", "", ""]
    assert move["panels"]["torque"]["names"] == (list(joints) if len(joints) > 1 else [""])


@pytest.mark.slow
def test_of_several_joints_a_limit_is_drawn_with_its_own(tmp_path):
    plant = ur5_with_bar().along(straight())
    limit = {"elbow_joint": 25.0}
    task = PointToPoint(plant, target=1.0, duration=1.0, torque_limit=limit)
    (move,) = trade_off(evaluate_coefficients(task, [0.01, -0.12, -0.04, 0.12])).moves
    panel = move["panels"]["torque"]
    limits = dict(zip(panel["names"], panel["limits"], strict=True))
    assert set(map(abs, limits.pop("elbow_joint"))) <= {25.0}
    assert not any(limits.values())


@pytest.fixture(scope="module")
def front(task):
    return epsilon_front(task, bound=0.2, points=5)


def points_of(front, **changes):
    (move,) = trade_off(replace(front, **changes)).moves
    return move["points"]


@pytest.mark.slow
def test_at_both_ends_and_between_a_sentence_says_what_is_saved(front):
    first, *between, last = points_of(front)
    stillest = front.points[0].energy
    assert first["sentence"].startswith(
        "The tip arrives at rest and takes 0.0445 J, 51 % less energy than"
    )
    for place, point in zip([*between, last], front.points[1:], strict=True):
        share, energy, at_rest = re.search(
            r" mm of residual vibration saves ([\d.]+) % of the energy: ([\d.]+) J, where "
            r"arriving at rest takes ([\d.]+) J\.", place["sentence"],
        ).groups()  # fmt: skip
        # two digits of a share, three of an energy
        assert float(share) == pytest.approx(100 * (1 - point.energy / stillest), rel=0.06)
        assert (float(energy), float(at_rest)) == pytest.approx((point.energy, stillest), rel=6e-3)
        assert float(energy) < float(at_rest)
    assert "would save" in first["sentence"]
    assert "would save" not in last["sentence"]


def test_a_step_that_leaves_the_front_is_not_offered(front):
    first, last = front.points[0], front.points[-1]
    # half a millimetre before the end: one millimetre more is no motion of this front
    near = FrontPoint(first.coefficients, last.residual - 0.5e-3, last.energy + 1e-5,
                      shadow_prices={"residual": 0.7})  # fmt: skip
    shown = points_of(front, points=(first, near, last))
    assert "would save" not in shown[1]["sentence"]
    # and it saves no more than the cheapest motion of all does
    little = replace(near, residual=10e-3)
    shown = points_of(front, points=(first, little, last))
    assert shown[1]["sentence"].endswith("One millimetre more would save about 10 \u00b5J.")


def test_energies_that_differ_little_are_told_apart_and_none_is_no_division(front):
    a, b, *_ = (point.coefficients for point in front.points)

    def second(*energies):
        two = [FrontPoint(a, 0.0, energies[0]), FrontPoint(b, 5e-3, energies[1])]
        return points_of(front, points=tuple(two))[1]["sentence"]

    assert second(25.43, 25.35).startswith(
        "5.00 mm of residual vibration saves 0.31 % of the energy: 25.35 J, where arriving at rest "
        "takes 25.43 J."
    )
    assert "saves 100 % of the energy: 0 J, where arriving at rest takes 0.0445 J" in second(
        0.0445, 0.0
    )


def test_a_cycloid_that_takes_no_energy_is_compared_by_no_share(front):
    (move,) = trade_off(replace(front, points=front.points[:1])).moves
    assert "51 % less energy than the plain cycloid" in move["points"][0]["sentence"]
    free = replace(front.task, energy=NoEnergy())
    (move,) = trade_off(evaluate_coefficients(free, [0.0, -0.1])).moves
    assert ", as much energy as the plain cycloid, which" in move["points"][0]["sentence"]


def test_where_stillness_takes_more_energy_a_sentence_says_what_that_buys():
    """README: at rest the arm takes 0.1315 J, the plain cycloid 0.1246 J, which leaves 15 mm."""
    task = TASKS["arm"]()
    still = plan_move(task, bound=0.5)
    (move,) = trade_off(still).moves
    assert move["points"][0]["sentence"] == (
        "The tip arrives at rest. That takes 0.131 J, 5.6 % more energy than the plain cycloid, "
        "and buys a still arrival: the cycloid leaves it swinging by up to 15.0 mm."
    )
    # more energy and more vibration buy nothing
    worse = evaluate_coefficients(task, [0.3, -0.3])
    (move,) = trade_off(worse).moves
    assert "more energy than the plain cycloid, which" in move["points"][0]["sentence"]


def test_methods_are_named_by_what_they_are(front, poor, task):
    (move,) = trade_off([front, poor], known_points=paper_points).moves
    assert move["method"] == "gradient (epsilon constraint)"
    assert described("epsilon:ipopt") == "gradient (epsilon constraint, IPOPT)"
    assert described("nsga2(crossover=0.7)") == "search (NSGA-II; crossover=0.7)"
    assert described("es") == "search ((1+1)-ES with an archive)"
    assert described("vepso, polished") == "search (VEPSO, polished)"
    assert [beside["label"] for beside in move["beside"]] == [
        "search (NSGA-II)", "the paper's best (6 terms)",
    ]  # fmt: skip


def test_a_limit_of_a_linear_axis_is_a_force():
    axis = PointToPoint(LinearAxis(), 0.3, 0.8, torque_limit=90.0)
    (move,) = trade_off(evaluate_coefficients(axis, [0.0, -0.1])).moves
    assert move["title"].endswith("force within 90 N")
    assert move["panels"]["torque"]["title"] == "Drive force"


@pytest.mark.parametrize(
    ("limit", "words"),
    [
        # docs/start.md: the plain cycloid's peak torque is 0.3628 N m
        ({"torque_limit": 0.15}, "0.363 N m of torque, beyond the limit of 0.15 N m"),
        # its acceleration is 2 pi times the angle over the duration squared: 5.140 rad/s^2
        (
            {"acceleration_limit": 4.0},
            "5.14 rad/s\u00b2 of acceleration, beyond the limit of 4 rad/s\u00b2",
        ),
        # the least torque, -0.3628 N m, over a bound of -0.2 N m
        ({"torque_limit": (-0.2, 0.15)}, "1.81 times its torque limit"),
    ],
)
def test_of_a_cycloid_that_breaks_a_limit_the_sentence_says_so(task, limit, words):
    plan = evaluate_coefficients(replace(task, **limit), [0.01, -0.17])
    (move,) = trade_off(plan).moves
    assert move["points"][0]["sentence"].endswith(f" The cycloid would reach {words}.")


def test_where_the_cycloid_keeps_the_limits_nothing_is_said_of_them(task):
    plan = evaluate_coefficients(replace(task, torque_limit=0.4), [0.01, -0.17])
    (move,) = trade_off(plan).moves
    assert move["points"][0]["sentence"].endswith("leaves it swinging by up to 77.1 mm.")
    assert "peak joint torque, moving [N m]" in move["figure_names"]


def test_the_plain_cycloid_itself_is_compared_with_none(cycloid, plan):
    (move,) = trade_off(cycloid).moves
    assert move["points"][0]["sentence"] == (
        "The tip swings by up to 77.1 mm after arrival and takes 0.0911 J; this is the plain "
        "cycloid itself."
    )  # docs/start.md: 77 mm; README: 0.0911 J
    (move,) = trade_off({"plan": plan, "plain": cycloid}).moves
    assert move["points"][1]["sentence"].startswith("plain: the tip swings by up to 77.1 mm")


def test_of_an_uncertain_task_a_sentence_is_of_the_worst_case_and_its_colour_green(task):
    uncertain = replace(task, uncertainty=Uncertainty({"frequency": 0.08}))
    plan = evaluate_coefficients(uncertain, [0.01, -0.17])
    (move,) = trade_off(plan).moves
    words = f"{1e3 * plan.residual:#.3g} mm"
    assert (
        f"swings by up to {words} after arrival in the worst case and takes"
        in (move["points"][0]["sentence"])
    )
    assert move["points"][0]["swing"] == f"swings \u00b1{words} at worst"
    assert (move["this"], move["mark"]) == ("robust-plan", "D")


def test_where_a_vibration_is_asked_for_on_arrival_nothing_is_called_rest(task):
    swinging = replace(task, final=ModalState((5e-3,), (0.0,)))
    plan = evaluate_coefficients(swinging, [0.01, -0.17])
    (move,) = trade_off(plan).moves
    (point,) = move["points"]
    words = f"{1e3 * plan.residual:#.3g} mm off what is asked"
    assert f"by up to {words} after arrival and takes" in point["sentence"]
    assert point["swing"] == f"\u00b1{words}"
    assert "rest" not in point["sentence"] + point["swing"] + point["cells"][0]
    assert not move["swings_about_rest"]


def test_colours_are_those_of_pictures_and_no_two_lie_beside_each_other_alike(front, poor, plan):
    page = trade_off(
        {"a": front, "b": poor, "c": plan, "d": plan, "e": poor}, known_points=paper_points
    )
    (move,) = page.moves
    looks = [(place["colour"], place["mark"]) for place in move["beside"]]
    assert move["this"] == "plan"
    assert looks[0] == ("search", "o")
    assert looks[-1] == ("paper", "*")
    assert len({*looks, ("plan", "o"), ("plain-cycloid", "s")}) == len(looks) + 2
    light, dark = re.findall(r"--plan: (#\w+);", page.html())[:2]
    assert (light, dark) == (MEANINGS["plan"].colour.lower(), MEANINGS["plan"].on_dark.lower())
    for number, colour in enumerate(OTHERS):
        assert f"--other-{number}: {colour.lower()};" in page.html()
    (searched,) = trade_off(poor).moves
    assert (searched["this"], searched["mark"]) == ("search", "o")


def test_a_move_of_milliseconds_is_shown_until_it_has_swung(done, folder):
    done(
        "plan linear-axis --set omega1=2000 --target 1um --duration 4ms --output small.html --quiet"
    )
    text = (folder / "small.html").read_text()
    (data,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', text)
    (move,) = json.loads(data)["moves"]
    assert move["end"] == pytest.approx(0.04, rel=0.02)  # of a residual window of 1 s
    assert move["residual"].endswith("within 1 s")
