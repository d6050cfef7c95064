"""`quietarm plan` and `quietarm evaluate`: what they find, show and write."""

import json
import math
import re
from pathlib import Path

import pytest
from lines import EVERY_FILE, MOVE, PLAN, run
from quietarm.ocp import CopperLoss, Plan, PositivePower


@pytest.fixture(scope="module")
def planned(tmp_path_factory):
    """One real run with every output, and a start that looks like an option."""
    where = tmp_path_factory.mktemp("planned")
    ran = run(
        "plan arm-on-flexible-link --start -pi/2 --target 45deg --duration 1000ms "
        "--torque-limit 0.4 --starts 2 --seed 3 --output plan.json --csv move.csv "
        "--sample-rate 250 --figure move.svg --quiet",
        cwd=where,
    )
    return where, ran


def test_a_plan_says_what_it_found_and_what_it_wrote(planned):
    where, ran = planned
    assert (ran.returncode, ran.stderr) == (0, "")
    assert ran.stdout.splitlines()[-3:] == ["wrote plan.json", "wrote move.csv", "wrote move.svg"]
    assert sorted(path.name for path in where.iterdir()) == ["move.csv", "move.svg", "plan.json"]
    found = Plan.load(where / "plan.json")
    settings = found.provenance.settings
    assert (settings.starts, settings.seed, found.task.torque_limit) == (2, 3, 0.4)
    assert "arm-on-flexible-link, -90 to 45 deg in 1 s" in ran.stdout
    assert f"{found.energy:.6g} J" in ran.stdout
    assert f"{found.motion.peak_torque:.4g} N m" in ran.stdout


def test_an_angle_below_zero_needs_no_equals_sign(call):
    line = "evaluate arm-on-flexible-link --start -pi/2 --target pi/2 --duration 1.2"
    assert call(f"{line} --residual-window 500ms --coefficients -0.1,-0.4 --output e.json")[0] == 0
    saved = Plan.load("e.json")
    assert saved.task.start == pytest.approx(-math.pi / 2, rel=1e-15)
    assert saved.task.residual_window == 0.5
    assert saved.coefficients == (-0.1, -0.4)


def test_limits_of_a_drive_by_direction_and_by_speed(call):
    line = "evaluate single-link --target 30deg --duration 0.8 --set zeta=1% --coefficients=0"
    typed = (
        "--acceleration-limit=-300deg:40 --torque-limit=-200mNm:0.3 --torque-speed 1.5Nm@0,1@190rpm"
    )
    assert call(f"{line} {typed} --output plan.json")[0] == 0
    task = Plan.load("plan.json").task
    assert task.plant.zeta == 0.01
    assert task.acceleration_limit == pytest.approx((-5 * math.pi / 3, 40.0), rel=1e-12)
    assert task.torque_limit == (-0.2, 0.3)
    assert task.torque_speed == ((1.5, 0.0), (1.0, pytest.approx(19.8968, rel=1e-5)))


@pytest.mark.parametrize(("limit", "warned"), [("", True), ("57", True), ("1.5", False)])
def test_a_limit_far_off_does_not_silence_the_warning_of_high_acceleration(call, limit, warned):
    given = f"--torque-limit {limit}" if limit else ""
    code, out, _ = call(f"plan single-link --target 30deg --duration 0.8 --starts 1 {given}")
    assert code == 0
    assert ("times the plain cycloid's" in out) is warned


def test_a_path_in_degrees_without_a_unit_is_asked_about(refused, folder):
    rows = [f"{k / 10},{30 * k / 4}" for k in range(5)]
    (folder / "path.csv").write_text("\n".join(["time_s,angle", *rows]))
    message = refused("evaluate single-link --path path.csv")
    assert "were degrees meant? name it angle_deg" in message


# Solves that fail: status 1


def test_a_torque_limit_that_is_too_low_says_the_least_that_would_do(refused, call):
    message = refused(f"{PLAN} --terms 3 --starts 2 --torque-limit 0.01 {EVERY_FILE}", status=1)
    assert "torque <= 0.01 N m" in message
    least = re.search(r"torque limit ([\d.]+) N m", message).group(1)
    code, _, _ = call(f"{PLAN} --terms 3 --starts 2 --torque-limit {least}")
    assert code == 0  # it does


def test_a_broken_limit_is_shown_with_what_is_reached(call):
    line = "evaluate single-link --target 30deg --duration 0.8 --coefficients=0"
    _, out, _ = call(f"{line} --torque-limit 0.01 --deflection-limit 1 --output plan.json")
    peak = Plan.load("plan.json").motion.peak_torque
    assert peak > 0.01
    shown = re.search(r"limits +(.*\S)", out).group(1)
    assert shown == f"torque 0.01 N m (broken: {peak:.4g} N m), deflection 1 m"


def test_an_energy_that_is_not_the_papers_is_named(call):
    line = "single-link --target 30deg --duration 0.8 --energy positive+copper:0.12 --quiet"
    named = "0 to 30 deg in 0.8 s, energy positive+copper:0.12"
    spent = {}
    for command in ("plan", "evaluate", "floor"):
        more = "--coefficients=0" if command == "evaluate" else ""
        code, out, err = call(f"{command} {line} {more} --output {command}.json")
        assert (code, err) == (0, "")
        assert named in " ".join(out.split())
        spent[command] = json.loads(Path(f"{command}.json").read_text())["motion"]["energy"]
    assert spent["floor"] < spent["plan"] < spent["evaluate"]
    assert Plan.load("plan.json").task.energy == PositivePower() + CopperLoss(0.12)
    _, out, _ = call(f"front {line} --method epsilon --points 2 --output front.json")
    assert "energy positive+copper:0.12" in out


def test_sensitivities_are_a_row_a_parameter_where_asked_for(call):
    line = f"evaluate {MOVE} --coefficients=0.003347,-0.1697"
    code, out, err = call(f"{line} --sensitivities")
    assert (code, err) == (0, "")
    rows = out.split("Sensitivities")[1]
    assert re.search(r"omega +[0-9.]+ +[-+][0-9.]+", rows)
    assert "Sensitivities" not in call(line)[1]


def test_modal_states_are_read_with_their_units(call):
    line = "evaluate dual-link --target 1 --duration 0.9 --coefficients=0 --output e.json"
    code, out, _ = call(f"{line} --initial 5mm,-0.01:0,40mm/s --final 0,1cm:0,0")
    found = Plan.load("e.json").task
    assert code == 0
    assert (found.initial.W, found.initial.dW) == ((0.005, -0.01), (0.0, 0.04))
    assert (found.final.W, found.final.dW) == ((0.0, 0.01), (0.0, 0.0))
    said = " ".join(out.split())
    assert "ringing at the start" in said
    assert "at the start W 5 and -10 mm, W' 0 and 40 mm/s" in said
    assert "to a state other than rest" in said
    assert "W 0 and 10 mm, W' 0 and 0 mm/s on arrival" in out


def test_a_polished_plan_says_by_which_solver(call, folder):
    line = f"plan {MOVE} --method nsga2 --bound 0.2 --residual-limit 1mm --polish --quiet"
    code, _, err = call(f"{line} --output p.json")
    assert (code, err) == (0, "")
    assert Plan.load(folder / "p.json").provenance.method == "nsga2, polished by sqp"
