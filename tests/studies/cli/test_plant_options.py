"""`--plant-file` and `--set`: a plant of one's own on every command, and parameters."""

import math

import pytest
from quietarm.models import Plant, SingleLinkManipulator, load_plant_file
from quietarm.ocp import Plan, PointToPoint, evaluate_coefficients

MOVE = "--target 1 --duration 3"
GIVEN = "--coefficients=0.1 --quiet"
SHORT = "--population 20 --generations 3 --bound 0.2 --quiet"


@pytest.fixture(autouse=True)
def folder(folder, monkeypatch, crane_file):
    """A folder of the test's own with the crane's file in it, and standing in it."""
    monkeypatch.setenv("COLUMNS", "200")
    return folder


def forget():
    """Forget the crane, as another process would not know it."""
    Plant._known.pop("crane", None)


@pytest.mark.parametrize("named", ["", "crane "])
def test_a_plant_of_a_file_is_evaluated_as_from_python(call, named):
    code, out, err = call(
        f"evaluate {named}{MOVE} --plant-file crane.py --set omega=2.5 {GIVEN} --output plan.json"
    )
    assert (code, err) == (0, "")
    assert "crane with omega = 2.5 rad/s, 0 to" in out
    crane = load_plant_file("crane.py")["crane"](omega=2.5)
    assert Plan.load("plan.json") == evaluate_coefficients(PointToPoint(crane, 1.0, 3.0), [0.1])


def test_plants_are_listed_with_what_their_parameters_mean(call):
    code, out, err = call("plants")
    assert (code, err) == (0, "")
    assert all(name in out for name in ("single-link", "arm-on-flexible-link", "dual-link"))
    code, out, _ = call("plants single-link")
    assert code == 0
    assert "omega   10.43 rad/s: frequency of the mode, hub held  (eq (10))" in out
    code, out, _ = call("plants --plant-file crane.py")
    assert code == 0
    assert out.startswith("crane")


def test_what_was_saved_is_read_with_the_plant_file_alone(call):
    code, _, err = call(
        f"front {MOVE} --plant-file crane.py --method nsga2 {SHORT} --output f.json "
        "--checkpoint c.npz"
    )
    assert (code, err) == (0, "")
    readers = (
        "polish f.json --points 2 --quiet --output p.json",
        "compare f.json p.json --no-floor --quiet",
    )
    for line in readers:
        forget()
        code, out, err = call(line)
        assert (code, out) == (2, "")
        assert "by --plant-file" in err
        assert call(f"{line} --plant-file crane.py")[0] == 0
    resume = f"front {MOVE} --method nsga2 {SHORT} --resume c.npz --plant-file crane.py"
    assert call(resume)[0] == 0


def test_what_was_saved_is_refused_with_a_changed_file(call, crane_file):
    front = f"front {MOVE} --plant-file crane.py --method nsga2 {SHORT}"
    assert call(f"{front} --output f.json --checkpoint c.npz")[0] == 0
    crane_file.write_text(crane_file.read_text().replace("0.4", "0.5"))
    for line in (
        "polish f.json --plant-file crane.py", "compare f.json g.json --plant-file crane.py",
        f"{front} --resume c.npz",
    ):  # fmt: skip
        code, out, err = call(line)
        assert (code, out, err.count("\n")) == (2, "", 1), line
        assert "sha" in err.lower()


def test_a_parameter_of_a_plant_of_quietarms_own_is_set(call):
    code, out, err = call(
        "evaluate single-link --target 30deg --duration 0.8 --coefficients=0.1 --quiet "
        "--set omega=9 --set zeta=0.01 --output plan.json"
    )
    assert (code, err) == (0, "")
    assert "single-link with zeta = 0.01, omega = 9 rad/s, 0" in out
    assert Plan.load("plan.json").task.plant == SingleLinkManipulator(omega=9.0, zeta=0.01)


def test_speeds_and_accelerations_take_degrees(call):
    code, _, err = call(
        f"evaluate single-link {MOVE} {GIVEN} --speed-limit 60deg --acceleration-limit 90deg/s^2 "
        "--jerk-limit 2pi --output plan.json"
    )
    assert (code, err) == (0, "")
    limits = Plan.load("plan.json").task.limits
    assert limits == pytest.approx(
        {"speed": math.pi / 3, "acceleration": math.pi / 2, "jerk": 2 * math.pi}, rel=1e-15
    )
