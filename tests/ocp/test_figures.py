"""Figures and quantities: units as values, and entries of one's own in Python."""

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import casadi as ca
import numpy as np
import pytest
from several_joints import TwoLinks

import quietarm as qa
from quietarm.models import JointMotion, LinearAxis, Plant, dimensions
from quietarm.models.dimensions import (
    ACCELERATION,
    DAMPING,
    EFFORT,
    INERTIA,
    SECOND,
    TIP,
    TORQUE,
    Unit,
    Words,
    words_of,
)
from quietarm.ocp import (
    FIGURES,
    QUANTITIES,
    Figure,
    Figures,
    Quantity,
    add_figure,
    add_quantity,
    final,
    remove_figure,
    remove_quantity,
    rms,
)
from quietarm.ocp import figures as table_of_figures


@pytest.mark.parametrize(
    ("unit", "rotary", "linear"),
    [
        (ACCELERATION, "rad/s^2", "m/s^2"),
        (EFFORT, "N m", "N"),
        (DAMPING, "N m s/rad", "N s/m"),
        (INERTIA, "kg m^2", "kg"),
        (Unit.named("K") / SECOND, "K/s", "K/s"),
        (EFFORT / TIP, "N", "N/m"),
        (Unit(), "", ""),
    ],
)
def test_a_unit_is_that_of_the_kind_of_joint(unit, rotary, linear):
    assert (unit.of("rotary"), unit.of("linear")) == (rotary, linear)
    assert unit.of("mixed") == (rotary if rotary == linear else f"{rotary} or {linear}")


def test_a_unit_is_that_of_the_tip_and_has_forms_for_every_place():
    rate = TIP / SECOND**2
    assert (rate.of("rotary", "m"), rate.of("linear", "rad")) == ("m/s^2", "rad/s^2")
    assert (rate.in_heading, rate.drawn, EFFORT.typed) == ("m_s2", "m/s²", "Nm")
    assert not rate.is_tip_way
    assert TIP.is_tip_way


@pytest.mark.parametrize("symbol", ["m/s", "s^2", "N m", ""])
def test_a_symbol_with_signs_is_no_unit(symbol):
    with pytest.raises(ValueError, match="products of units"):
        Unit.named(symbol)


def test_words_of_a_name_are_looked_up_and_never_edited():
    assert str(TORQUE.within("peak {}").on("linear")) == "peak force"
    for name in ("radial-axis", "torque-arm", "angle_of_view"):
        assert words_of(name).of("linear") == name


TIP_ACCELERATION = Quantity(
    name="tip_acceleration",
    unit=TIP / SECOND**2,
    label=Words("tip acceleration"),
    values=lambda sample: sample.tip_accelerations,
    in_scenarios=True,
)
RMS_TORQUE = Figure("rms_torque", EFFORT, Words("RMS torque", "RMS force"), rms("torque"))


@pytest.fixture
def own():
    """Entries of one's own, known in a test alone."""
    yield add_quantity(TIP_ACCELERATION), add_figure(RMS_TORQUE)
    remove_quantity(TIP_ACCELERATION.name)
    remove_figure(RMS_TORQUE.name)


@pytest.fixture
def task():
    return qa.PointToPoint(qa.SingleLinkManipulator(), math.pi / 6, 0.8)


def test_figures_of_a_motion_are_a_mapping_and_attributes(task):
    figures = qa.evaluate_coefficients(task, [0.1, 0.1]).figures
    assert list(figures) == [name for name in FIGURES if name != "acts_after"]  # of a band
    assert figures["peak_torque"] == figures.peak_torque == figures.peak("torque")
    with pytest.raises(AttributeError, match="there is no figure 'peak_torqe'"):
        _ = figures.peak_torqe


def test_what_is_infinite_is_no_figure():
    figures = Figures({"residual": 0.0, "energy": 1.0, "peak_jerk": math.inf})
    assert "peak_jerk" not in figures
    assert figures.peak("jerk") == math.inf


def test_the_root_mean_square_is_that_of_the_integral(task):
    """The plain cycloid's acceleration, 2 pi D / T^2 sin(2 pi t / T), has its peak over sqrt 2."""
    candidate = qa.evaluate_coefficients(task, []).candidate
    peak = 2 * math.pi * task.span / task.duration**2
    assert rms("acceleration")(candidate) == pytest.approx(peak / math.sqrt(2), rel=1e-9)
    assert final("speed")(candidate) == pytest.approx(0.0, abs=1e-12)
    assert candidate.weights.sum() == pytest.approx(task.duration, rel=1e-12)


def test_a_figure_of_ones_own_is_on_every_page_of_a_plan(own, task, tmp_path):
    plan = qa.evaluate_coefficients(task, [0.1, 0.1])
    words = f"{rms('torque')(plan.candidate):.4g} N m"
    assert f"<td>RMS torque</td><td>{words}</td>" in plan._repr_html_()
    plan.save(tmp_path / "plan.json")
    assert qa.Plan.stated_by(tmp_path / "plan.json")["rms_torque"] == plan.figures["rms_torque"]
    axis = qa.evaluate_coefficients(qa.PointToPoint(LinearAxis(), 0.3, 0.8), [0.1])
    assert "<td>RMS force</td>" in axis._repr_html_()


def test_a_front_has_a_column_of_it(own, task):
    front = qa.Front.from_coefficients(task, [[0.1, 0.1]], method="mine")
    (value,) = front.columns()["rms_torque_Nm"]
    assert value == rms("torque")(front.judged(front.points[0]))
    assert "RMS torque [N m]" in front._repr_html_()


def test_a_limit_of_ones_own_is_a_keyword_and_an_entry_of_files(own, task, tmp_path):
    limited = replace(task, tip_acceleration_limit=(-8.0, 9.0), torque_limit=0.4)
    assert limited.tip_acceleration_limit == (-8.0, 9.0)
    assert [str(limit) for limit in limited.limits] == [
        "torque 0.4 N m", "tip acceleration -8 to 9 m/s^2",
    ]  # fmt: skip
    assert replace(limited, duration=0.9).bounds == limited.bounds
    assert replace(limited, torque_limit=None).bounds == {"tip_acceleration": (-8.0, 9.0)}
    assert not replace(limited, bounds={}).limits
    plan = qa.evaluate_coefficients(limited, [0.1, 0.1])
    plan.save(tmp_path / "plan.json")
    assert qa.Plan.load(tmp_path / "plan.json") == plan
    remove_quantity("tip_acceleration")
    with pytest.raises(qa.ocp.FileFormatError, match="'tip_acceleration_limit' is not known here"):
        qa.Plan.load(tmp_path / "plan.json")
    with pytest.raises(ValueError, match="'tip_acceleration' that the task limits is not known"):
        _ = limited.limits


@pytest.mark.parametrize("solver", [qa.Sqp(), qa.Ipopt()])
def test_a_plan_keeps_it(own, task, solver):
    limited = replace(task, duration=1.2, tip_acceleration_limit=2.0)
    plan = qa.plan_move(limited, qa.CycloidPolynomial(8), starts=1, solver=solver)
    assert plan.residual < 1e-6
    peak = np.abs(plan.candidate.values_of(QUANTITIES["tip_acceleration"])).max()
    assert 1.9 < peak <= 2.0 * (1 + 1e-6)
    assert "tip_acceleration" in plan.shadow_prices


@pytest.mark.parametrize(
    ("keyword", "told"),
    [("torqe_limit", "did you mean 'torque_limit'"), ("colour", "unknown argument 'colour'")],
)
def test_a_limit_that_is_not_known_is_refused(task, keyword, told):
    with pytest.raises(TypeError, match=told):
        replace(task, **{keyword: 1.0})


@pytest.mark.parametrize("name", ["torque", "residual", "tip acceleration", "Tip"])
def test_a_name_that_is_taken_or_is_none_is_refused(name):
    with pytest.raises(ValueError, match="give"):
        add_quantity(replace(TIP_ACCELERATION, name=name))


@pytest.mark.parametrize("name", ["energy", "peak_torque", "RMS torque"])
def test_so_is_a_figures(name):
    with pytest.raises(ValueError, match="give"):
        add_figure(replace(RMS_TORQUE, name=name))


@pytest.mark.parametrize(
    ("values", "told"),
    [
        (lambda sample: sample.tip_jerks, "has no attribute 'tip_jerks'.*as lambda sample"),
        (lambda sample: [], "returns"),
        (lambda sample: ["fast"], "returns"),
    ],
)
def test_a_function_that_fails_is_refused_where_it_is_added(values, told):
    with pytest.raises(ValueError, match=told):
        add_quantity(replace(TIP_ACCELERATION, values=values))


@pytest.mark.parametrize("of", [lambda candidate: "much", lambda candidate: candidate.speed])
def test_a_figure_that_is_no_number_is_refused_in_a_line(task, of):
    add_figure(replace(RMS_TORQUE, of=of))
    try:
        with pytest.raises(ValueError, match=r"'rms_torque' fails .*; give a function of a"):
            qa.evaluate_coefficients(task, [])._repr_html_()
    finally:
        remove_figure("rms_torque")


def test_rates_of_tips_are_those_of_the_equations():
    """The second derivative against differences of the first, which the plant gives itself."""
    plant = TwoLinks()
    size = 4 + 3 * plant.modes
    random = np.random.default_rng(0).uniform(-1, 1, size)
    random[0] = 0.4

    def parts(numbers):
        modes = np.split(np.asarray(numbers)[4:], 3)
        return JointMotion(*numbers[:4]), *map(list, modes)

    path, W, dW, ddW = parts(random)
    step = 1e-5

    def speeds(later):
        """Along the motion that these are the first derivatives of."""
        place = path.angle + later * path.speed + later**2 / 2 * path.acceleration
        speed = path.speed + later * path.acceleration
        moved = [w + later * v + later**2 / 2 * a for w, v, a in zip(W, dW, ddW)]
        rates = [v + later * a for v, a in zip(dW, ddW)]
        return np.array(plant.tip_speeds(JointMotion(place, speed, 0.0), moved, rates), float)

    due = (speeds(step) - speeds(-step)) / (2 * step)
    assert np.ravel(plant.tip_accelerations(path, W, dW, ddW)) == pytest.approx(due, rel=1e-7)
    assert np.ravel(Plant.tip_speeds(plant, path, W, dW)) == pytest.approx(speeds(0.0), rel=1e-12)


def test_formulas_of_a_plant_are_checked_against_casadi():
    class Wrong(TwoLinks):
        name = "wrong-accelerations"

        def tip_accelerations(self, path, W, dW, ddW):
            return self.tips_at(path, ddW)

    with pytest.raises(ValueError, match=r"tip_accelerations gives a rate of .* time derivatives"):
        Wrong().validate()


@pytest.fixture
def tip_acceleration():
    yield add_quantity(
        Quantity(
            name="tip_rush",
            unit=TIP / SECOND**2,
            label=Words("tip rush"),
            values=lambda sample: sample.tip_accelerations,
        )
    )
    remove_quantity("tip_rush")


@pytest.mark.usefixtures("tip_acceleration")
def test_a_tip_that_depends_on_the_place_has_rates_by_casadi():
    @dataclass(frozen=True)
    class TipByPlace(Plant):
        """A swing whose tip's displacement depends on the joint's place; it gives no rates."""

        name: ClassVar[str] = "tip-by-place"
        modes: ClassVar[int] = 1

        def modal_accelerations(self, joint, W, dW):
            """A swing."""
            return [-81.0 * W[0] - 0.05 * dW[0] - 0.5 * joint.acceleration]

        def torque(self, joint, W, dW, ddW):
            """Return the torque of an inertia and the swing."""
            return 2.0 * joint.acceleration + 0.5 * ddW[0]

        def tips_at(self, path, W):
            """By the joint's place."""
            (joint,) = self.joints(path)
            return [(1 + 0.2 * ca.sin(joint.angle)) * W[0]]

    task = qa.PointToPoint(TipByPlace(), 0.5, 1.2, tip_rush_limit=20.0)
    plan = qa.plan_move(task, qa.CycloidPolynomial(3))
    time = np.linspace(0, 1.2, 8001)
    tip = plan.sampled(time).tips[:, 0]
    rush = np.gradient(np.gradient(tip, time), time)[4:-4]
    assert np.abs(rush).max() == pytest.approx(plan.figures["peak_tip_rush"], rel=1e-3)


@pytest.mark.usefixtures("tip_acceleration")
def test_an_own_limit_does_not_bound_how_soon_a_joint_arrives():
    task = qa.PointToPoint(qa.SingleLinkManipulator(), math.pi / 6, 2.5, tip_rush_limit=0.05)
    assert qa.plan_move(task, qa.CycloidPolynomial(6)).figures["peak_tip_rush"] < 0.0501
    # refused before, as if a structure could not bend that slowly
    loose = qa.plan_move(task, qa.CycloidPolynomial(6), residual_limit=1e-3)
    assert loose.figures["peak_tip_rush"] < 0.0501


@pytest.mark.parametrize("kind", [Figure, Quantity])
def test_the_example_in_a_message_is_one(kind):
    code = kind.example.partition(", such as ")[2].partition(", with unit and words of ")[0]
    made = eval(code, {**vars(dimensions), **vars(table_of_figures)})
    assert isinstance(made, kind)
    add, remove = {Figure: (add_figure, remove_figure), Quantity: (add_quantity, remove_quantity)}[
        kind
    ]
    try:
        add(made)
    finally:
        remove(made.name)
