"""`quietarm plan`: what it finds, shows and writes."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from lines import MOVE

from quietarm.ocp import CopperLoss, Floor, Plan, PositivePower, plan_move


def test_a_plan_says_what_it_found_and_what_it_wrote(folder, done):
    """With a start that looks like an option."""
    out = done(
        "plan arm-on-flexible-link --start -pi/2 --target 45deg --duration 1000ms "
        "--torque-limit 0.4 --terms 6 --starts 2 --seed 3 --output plan.json --output move.csv "
        "--output move.pdf --quiet"
    )
    assert out.splitlines()[-3:] == ["wrote plan.json", "wrote move.csv", "wrote move.pdf"]
    assert sorted(path.name for path in folder.iterdir()) == ["move.csv", "move.pdf", "plan.json"]
    found = Plan.load("plan.json")
    record = found.record
    assert (record.settings["starts"], record.seed, found.task.torque_limit) == (2, 3, 0.4)
    assert "arm-on-flexible-link, -90 to 45 deg in 1 s" in out
    assert f"{found.energy:.4g} J" in out
    assert f"{found.motion.peak_torque:.4g} N m" in out


def test_json_goes_to_standard_output_and_words_to_standard_error(call, plan):
    code, out, err = call(f"plan {MOVE} --terms 2 --quiet --output -")
    assert code == 0
    assert json.loads(out)["stated"]["energy"] == pytest.approx(plan.energy, rel=1e-9)
    assert err.startswith("This plan takes ")


@pytest.mark.slow
def test_the_motion_without_a_parametrisation_takes_less(done):
    line = "plan arm-on-flexible-link --target pi/2 --duration 0.8 --acceleration-limit 100 --quiet"
    out = done(f"{line} --profile free --starts 2 --seed 3 --output f.json --output f.png")
    floor = Floor.load("f.json")
    assert (floor.record.settings["starts"], floor.record.seed, floor.smooth) == (2, 3, False)
    assert floor.tolerance == 0.005
    plan = plan_move(floor.task)
    assert plan.energy > floor.energy
    for energy in (plan.energy, floor.energy):
        assert f"{energy:.4g} J" in out
    assert Path("f.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_a_robust_plan_keeps_its_limit_in_the_worst_case(done):
    out = done(f"plan {MOVE} --error frequency=4% --starts 1 --output p.json --quiet")
    found = Plan.load("p.json")
    assert found.task.ranges == {"frequency": 0.04}
    assert found.excess <= 0
    error = 100 * found.worst.errors["frequency"]
    assert f"{1e3 * found.worst.residual:.3g} mm with frequency {error:+.3g} %" in out


@pytest.mark.slow
def test_an_energy_that_is_not_the_papers_is_named(done):
    line = "single-link --target 30deg --duration 0.8 --energy positive+copper:0.12 --quiet"
    energies = {}
    for name, words in (
        ("free", "plan --profile free"), ("plan", "plan"), ("cycloid", "evaluate --coefficients=0")
    ):  # fmt: skip
        out = done(f"{words} {line} --output {name}.json")
        assert "0 to 30 deg in 0.8 s, energy positive+copper:0.12" in " ".join(out.split())
        energies[name] = json.loads(Path(f"{name}.json").read_text())["stated"]["energy"]
    assert energies["free"] < energies["plan"] < energies["cycloid"]
    assert Plan.load("plan.json").task.energy == PositivePower() + CopperLoss(0.12)


def test_sensitivities_are_a_row_a_parameter_where_asked_for(call, done):
    line = f"evaluate {MOVE} --coefficients=0.003347,-0.1697"
    out = done(f"{line} --sensitivities")
    assert re.search(r"^omega \(frequency\) +[0-9.]+ mm, [-+][0-9.]+ %", out, re.MULTILINE)
    assert "1 % larger" not in call(line)[1]


def test_states_and_limits_of_a_drive_are_typed_with_units_by_direction_and_by_speed(call, done):
    done(
        "evaluate dual-link --target 1 --duration 0.9 --coefficients=0 --quiet --output e.json "
        "--speed-limit 60deg --acceleration-limit=-300deg:720deg --jerk-limit 2pi "
        "--torque-limit=-200mNm:300mNm --torque-speed 1.5Nm@0,1@190rpm "
        "--initial 5mm,-0.01:0,40mm/s --final 0,1cm:0,0 --residual-window 500ms"
    )
    task = Plan.load("e.json").task
    limits = task.speed_limit, task.jerk_limit, *task.acceleration_limit
    exact = math.pi / 3, 2 * math.pi, -5 * math.pi / 3, 4 * math.pi
    assert limits == pytest.approx(exact, rel=1e-15)
    assert task.torque_limit == (-0.2, 0.3)
    assert task.torque_speed == ((1.5, 0.0), (1.0, pytest.approx(19.8968, rel=1e-5)))
    assert (task.initial.W, task.initial.dW) == ((0.005, -0.01), (0.0, 0.04))
    assert (task.final.W, task.final.dW) == ((0.0, 0.01), (0.0, 0.0))
    assert task.residual_window == 0.5
    line = f"evaluate {MOVE} --coefficients=0 --acceleration-limit 90deg/s^2 --output e.json"
    assert call(line)[0] == 0
    assert Plan.load("e.json").task.acceleration_limit == pytest.approx(math.pi / 2, rel=1e-15)


@pytest.mark.parametrize(
    "typed", ["100N@0,40N@0.5mps", "100@0,40@500mm/s", "0.1kN@0,40N@0.5m/s", "100@0,40@0.5"]
)
def test_the_force_of_a_linear_drive_falls_with_speed(done, typed):
    out = done(
        "evaluate linear-axis --target 300mm --duration 1.0 --coefficients 0 --quiet "
        f"--output e.json --torque-speed {typed}"
    )
    assert "force-speed 100N@0,40N@0.5" in out
    plan = Plan.load("e.json")
    assert plan.task.torque_speed == ((100.0, 0.0), (40.0, 0.5))
    # force + 120 N s/m |speed| within 100 N: the line's force, less its fall, by hand
    at = plan.sampled(np.linspace(0.0, 1.0, 1001))
    shares = (np.abs(at.torque) + 120 * np.abs(at.joint[:, 1])) / 100
    (limit,) = plan.task.limits
    assert limit.peak_of(plan.motion) == pytest.approx(shares.max(), rel=1e-3)


@pytest.mark.slow_after(1)
@pytest.mark.parametrize(
    ("limits", "warned"),
    [
        # measured: the acceleration changes by its peak in 1.5 and in 20 ms
        ("--acceleration-limit 40", "in 1.5 ms; give what the drive can do, such as --jerk-limit"),
        ("--acceleration-limit 40 --jerk-limit 2000", ""),
        ("--terms 3", ""),  # in 30 ms
    ],
)
def test_a_jerk_that_would_surprise_a_drive_is_told(done, limits, warned):
    out = " ".join(done(f"plan {MOVE} --starts 1 {limits} --quiet").split())
    (jerk,) = re.findall("peak jerk .* peak deflection", out)
    assert ("warning" in jerk) is bool(warned)
    assert warned in jerk


@pytest.mark.slow_after(1)
@pytest.mark.parametrize(("limit", "warned"), [("", True), ("57", True), ("1.5", False)])
def test_a_limit_far_off_does_not_silence_the_warning_of_high_acceleration(call, limit, warned):
    given = f"--torque-limit {limit}" if limit else ""
    code, out, _ = call(f"plan {MOVE} --starts 1 {given}")
    assert code == 0
    assert ("times the plain cycloid's" in out) is warned


@pytest.mark.slow
def test_a_linear_axis_is_in_metres_and_newtons_from_the_line_to_the_c(call, done, folder):
    out = done(
        "plan linear-axis --target 300mm --duration 0.5 "
        "--acceleration-limit=-9000mm/s^2:10000mm/s^2 --terms 6 --quiet "
        "--output axis.json --output axis.csv --output axis.png"
    )
    assert "0 to 300 mm in 0.5 s" in out
    assert "acceleration -9 to 10 m/s^2" in out
    assert re.search(r"peak force +[\d.]+ N\s", out)
    assert not re.search(r"\brad|deg|N m", out)
    header, *rows = Path("axis.csv").read_text().splitlines()
    assert header == "time_s,position_m,speed_m_s,acceleration_m_s2,tip_m,force_N,power_W"
    assert float(rows[-1].split(",")[1]) == pytest.approx(0.3, abs=1e-9)
    assert call("export axis.json --output axis.c")[0] == 0
    assert "The joint's position [m], speed [m/s]" in Path("axis.h").read_text()
    assert call("export axis.json --output mm.csv --columns time:ms,angle:mm,torque")[0] == 0
    assert Path("mm.csv").read_text().startswith("time_ms,position_mm,force_N\n")
    code, out, _ = call("compare axis.json --baselines zvd --output compared")
    assert (code, "force [N]" in out, "rad" in out) == (0, True, False)
    line = "plan linear-axis --target 300mm --duration 0.3 --terms 6"
    code, _, err = call(f"{line} --torque-limit 30")
    words = r"within the limits of force even a rigid joint takes .* force limit [\d.]+ N"
    assert (code, bool(re.search(words, err))) == (1, True)
    code, out, err = call(
        "evaluate linear-axis --target 8m --duration 3 --coefficients 0"
    )  # no degrees meant
    assert (code, err, "0 to 8000 mm" in out) == (0, "", True)
