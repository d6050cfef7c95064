"""The answer a person keeps: figures, equality, files to load, tables to drive a joint with."""

import csv
import math
from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.ocp import (
    MAX_TERMS,
    CycloidPolynomial,
    Motion,
    Plan,
    PointToPoint,
    SolveStatus,
    Verification,
    evaluate_coefficients,
    resimulate,
)
from quietarm.ocp.answers.provenance import Provenance

# Table 1, N = 2.
TWO_TERMS = [3.347e-3, -1.697e-1]


@pytest.fixture(scope="module")
def plan(tasks):
    """The single link along the paper's two terms."""
    return evaluate_coefficients(tasks["single link"], TWO_TERMS)


@pytest.fixture(params=["single link", "arm", "two links"])
def any_plan(request, tasks, solved):
    return solved(tasks[request.param], 4)


# -- given coefficients --


@pytest.mark.parametrize(
    ("energies", "residuals", "agrees"),
    [  # by the fixed steps, by CVODES: a thousandth of either, or a micrometre, is the README's
        ((1.0009, 1.0), (0.0, 0.0), True),
        ((1.0011, 1.0), (0.0, 0.0), False),
        ((0.9989, 1.0), (0.0, 0.0), False),
        ((1.0, 1.0), (0.9e-6, 0.0), True),
        ((1.0, 1.0), (1.1e-6, 0.0), False),
        ((1.0, 1.0), (1.0009e-2, 1e-2), True),
        ((1.0, 1.0), (0.9989e-2, 1e-2), False),
    ],
)
def test_what_counts_as_verified(plan, energies, residuals, agrees):
    motion = replace(plan.motion, energy=energies[1], residual=residuals[1])
    assert Verification.between(80, energies[0], residuals[0], motion).agrees == agrees


def test_given_coefficients_are_not_said_to_be_optimal(plan):
    assert plan.status is SolveStatus.NOT_OPTIMISED
    assert plan.provenance.method == "given coefficients"
    assert plan.provenance.settings is None
    assert plan.provenance.search == {}


@pytest.mark.parametrize(
    "a", [[math.nan], [0.0, math.inf], [0.0] * (MAX_TERMS + 1), "ab", [[0.1], [0.1]]]
)
def test_coefficients_that_are_not_as_many_finite_numbers_as_may_be_are_refused(tasks, a):
    too_many = f"terms is {MAX_TERMS + 1}"
    with pytest.raises(ValueError, match=rf"coefficient|{too_many}|could not convert") as error:
        evaluate_coefficients(tasks["arm"], a)
    assert "\n" not in str(error.value)


# -- a value --


def test_a_plan_cannot_be_changed(plan):
    with pytest.raises(FrozenInstanceError):
        plan.coefficients = ()


def test_the_path_is_the_joints(plan):
    assert plan.path(0.0) == 0.0
    assert plan.path(0.8) == pytest.approx(math.pi / 6)
    assert plan.path.coefficients == plan.coefficients


def test_versions_and_time_are_kept(plan):
    assert set(plan.provenance.versions) == {"quietarm", "casadi", "numpy", "python"}
    assert plan.provenance.versions["numpy"] == np.__version__
    assert plan.provenance.seconds > 0


# -- saved and loaded --


def test_a_saved_plan_loads_equal(any_plan, tmp_path):
    any_plan.save(tmp_path / "plan.json")
    loaded = Plan.load(tmp_path / "plan.json")
    assert loaded == any_plan
    assert {loaded, any_plan} == {any_plan}  # so that plans can be looked up
    assert loaded.provenance.seconds == any_plan.provenance.seconds
    assert loaded.motion == resimulate(loaded.task, loaded.profile, loaded.coefficients)


finite = st.floats(allow_nan=False, allow_infinity=False)
positive = st.floats(1e-6, 1e6)


@st.composite
def made_up_plans(draw):
    """Plans of any numbers, as no solve gives them."""
    plant_class = draw(st.sampled_from([SingleLinkManipulator, ArmOnFlexibleLink]))
    limits = draw(st.dictionaries(st.sampled_from(["torque_limit", "speed_limit"]), positive))
    task = PointToPoint(
        plant_class(omega=draw(positive)),
        start=draw(st.floats(-10, 0)),
        target=draw(st.floats(0.1, 10)),
        duration=draw(positive),
        residual_window=draw(positive),
        **limits,
    )
    coefficients = tuple(draw(st.lists(finite, max_size=20)))
    texts = st.text(st.characters(exclude_categories=["Cs", "Cc", "Cf", "Zl", "Zp"]))
    words = st.dictionaries(texts, st.none() | finite | st.integers() | texts)
    return Plan(
        task,
        CycloidPolynomial(len(coefficients)),
        coefficients,
        Motion(*draw(st.lists(finite, min_size=8, max_size=8))),
        draw(st.sampled_from(SolveStatus)),
        Verification(draw(st.integers(1, 9999)), *draw(st.lists(finite, min_size=4, max_size=4))),
        Provenance(draw(texts), None, draw(words), {"any": draw(texts)}, 0.5),
    )


@settings(max_examples=30)
@given(plan=made_up_plans())
def test_any_plan_saves_and_loads_equal(tmp_path_factory, plan):
    path = tmp_path_factory.mktemp("plans") / "plan.json"
    plan.save(path)
    assert Plan.load(path) == plan


# -- tables --


def _table(plan, path, *rate):
    plan.save_csv(path, *rate)
    with path.open(newline="") as file:
        header, *rows = csv.reader(file)
    return header, np.array(rows, dtype=float)


def test_a_table_names_its_quantities_and_units(plan, tmp_path):
    header, _ = _table(plan, tmp_path / "move.csv")
    assert header == [
        "t_s",
        "theta_rad",
        "dtheta_rad_s",
        "ddtheta_rad_s2",
        "tip_m",
        "torque_Nm",
        "power_W",
    ]


def test_two_tips_have_a_column_each(tasks, solved, tmp_path):
    header, rows = _table(solved(tasks["two links"], 4), tmp_path / "move.csv", 100)
    assert header[4:6] == ["tip_1_m", "tip_2_m"]
    assert rows.shape == (91, 8)
    assert np.abs(rows[-1, 4:6]).max() < 1e-7
    assert np.abs(rows[:, 4] - rows[:, 5]).max() > 1e-3


@pytest.mark.parametrize(
    ("rate", "rows"),
    # 0.8 s: as many ticks as begin before arrival, and one at or after it.
    [((), 801), ((1000,), 801), ((100.0,), 81), ((333.3,), 268), ((7,), 7), ((1,), 2), ((0.1,), 2)],
)
def test_a_table_has_a_row_for_every_tick_up_to_arrival(plan, tmp_path, rate, rows):
    _, table = _table(plan, tmp_path / "move.csv", *rate)
    ticks = np.arange(rows) / (rate[0] if rate else 1000.0)
    assert table[:, 0] == pytest.approx(ticks, rel=1e-9)
    assert table[-1, 0] >= 0.8 - 1e-9
    assert table[-2, 0] < 0.8


@pytest.mark.parametrize("rate", [1000.0, 333.3, 1.0, 1e-3])
def test_the_last_row_rests_at_the_target(plan, tmp_path, rate):
    _, table = _table(plan, tmp_path / "move.csv", rate)
    assert table[0, 1:5] == pytest.approx(np.zeros(4), abs=1e-12)
    assert table[-1, 1:4] == pytest.approx([math.pi / 6, 0.0, 0.0], abs=1e-9)
    assert table[-1, -1] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("duration", [1 - 0.9, 1.7 - 0.9, 0.1 + 0.2, 0.7 * 1.1])
def test_a_duration_that_is_a_tick_but_for_rounding_ends_at_that_tick(tasks, tmp_path, duration):
    plan = evaluate_coefficients(replace(tasks["arm"], duration=duration), [])
    _, table = _table(plan, tmp_path / "move.csv", 1000)
    assert len(table) == round(duration * 1000) + 1
    assert table[-1, 1:4] == pytest.approx([math.pi / 2, 0.0, 0.0], abs=1e-9)


def test_a_table_agrees_with_path_and_trajectory(any_plan, tmp_path):
    _, table = _table(any_plan, tmp_path / "move.csv", 200)
    t, digits = table[:, 0], 1e-9  # ten digits are written
    for order in range(3):
        expected = any_plan.path(t, order)
        close = digits * max(np.abs(expected).max(), 1.0)
        assert table[:, 1 + order] == pytest.approx(expected, abs=close)
    sampled = any_plan.sampled(t)
    tips = sampled.tips.shape[1]
    assert table[:, 4 : 4 + tips] == pytest.approx(sampled.tips, abs=digits)
    assert table[:, 4 + tips] == pytest.approx(sampled.torque, abs=digits)
    assert table[:, 5 + tips] == pytest.approx(sampled.power, abs=digits)


def test_a_sample_rate_beyond_reason_is_named(plan, tmp_path):
    with pytest.raises(ValueError, match=r"1e\+12 Hz asks for 800000000000 rows"):
        plan.save_csv(tmp_path / "move.csv", 1e12)
    assert list(tmp_path.iterdir()) == []
