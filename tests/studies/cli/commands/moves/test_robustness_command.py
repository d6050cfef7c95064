"""`quietarm robustness`: what it says, what it writes, what it refuses."""

import csv
import json
import math
from dataclasses import replace

import numpy as np
import pytest
from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.ocp import (
    PointToPoint,
    Uncertainty,
    evaluate_coefficients,
    evaluate_robustness,
    plan_move,
    shaped_cycloid,
)

FILES = {"report.md", "robustness.csv", "sweeps.csv", "samples.csv", "robustness.png"}
RANGES = {"frequency": 0.1, "damping": 0.5}


@pytest.fixture(scope="module")
def plans():
    """Two plans of the single link and one of the arm, by the names of their files."""
    task = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8)
    arm = PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8)
    return {
        "ours": plan_move(task, bound=0.2),
        "zv": plan_move(task, shaped_cycloid(task, "zv")),
        "arm": evaluate_coefficients(arm, []),
        "robust": evaluate_coefficients(
            replace(task, uncertainty=Uncertainty({"frequency": 0.1})), []
        ),
    }


@pytest.fixture(autouse=True)
def folder(folder, monkeypatch, plans):
    monkeypatch.setenv("COLUMNS", "200")
    for name, plan in plans.items():
        plan.save(f"{name}.json")
    return folder


@pytest.fixture
def call(call):
    """Run `robustness` with these words in this process."""
    return lambda line: call(f"robustness {line}")


def rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def test_it_shows_and_writes_the_figures_of_every_plan(call, plans, folder):
    code, out, err = call(
        "ours.json zv.json --frequency 10% --damping=0.5 --samples 300 --seed 5 --output out"
    )
    assert code == 0
    assert err.endswith("1404 of 1404 evaluations\n")  # of each plan 2 x 201, and 300
    assert {path.name for path in (folder / "out").iterdir()} == FILES
    table, samples = (rows(folder / "out" / f"{name}.csv") for name in ("robustness", "samples"))
    assert [row["plan"] for row in table] == ["ours", "zv"]
    for row in table:
        plan = plans[row["plan"]]
        found = evaluate_robustness(
            plan.task, plan.profile, plan.coefficients, RANGES, samples=300, seed=5
        )
        expected = {
            "residual_mm": 1e3 * found.assumed.residual[0],
            "residual_mm_p95": 1e3 * np.percentile(found.samples.residual, 95),
            "residual_frequency_lower_mm": 1e3 * found.sweeps[0].figures.residual[0],
            "residual_damping_higher_mm": 1e3 * found.sweeps[1].figures.residual[-1],
            "frequency_tolerated_to_percent": 100 * found.sweeps[0].insensitivity[1],
            "energy_J_p100": found.samples.energy.max(),
            "peak_torque_Nm_p50": np.median(found.samples.peak_torque),
        }
        assert {name: float(row[name]) for name in expected} == pytest.approx(expected)
        assert f"{1e3 * found.cycloid:.3g}" in out
        mine = [float(each["energy_J"]) for each in samples if each["plan"] == row["plan"]]
        assert mine == found.samples.energy.tolist()
    assert "seed 5" in out


def test_errors_of_parameters_stand_between_plans_and_options(call):
    code, out, _ = call("--omega=10% ours.json --samples 10 --beta1 0.05 zv.json --quiet")
    assert code == 0
    assert "+-10 % of omega, +-5 % of beta1" in out
    assert "frequency" not in out.split("- The joint")[0]


@pytest.mark.parametrize(
    ("figure", "told"),
    [("residual", "states residual"), ("peak_torque", "states peak torque")],
)
def test_a_plan_is_a_claim(call, folder, figure, told):
    document = json.loads((folder / "arm.json").read_text())
    document["motion"][figure] *= 1.01
    (folder / "arm.json").write_text(json.dumps(document))
    code, out, err = call("arm.json --quiet")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert f"arm.json {told}" in err
    assert "find the plan again" in err


@pytest.mark.parametrize(
    ("entry", "value", "told"),
    [
        ("residual", 1e-3, "robust.json states residual 0.001 m at worst, but its coefficients "),
        ("errors", {"damping": 0.01}, "robust.json states a worst with errors of damping, which"),
    ],
)
def test_the_worst_of_a_plan_is_a_claim(call, plans, folder, entry, value, told):
    plan = plans["robust"]
    plan.save("robust.json")
    assert call("robust.json --samples 1 --omega 5% --frequency 5% --quiet")[0] == 0
    document = json.loads((folder / "robust.json").read_text())
    document["worst"][entry] = value
    (folder / "robust.json").write_text(json.dumps(document))
    code, out, err = call("robust.json --samples 1 --quiet")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert told in err
