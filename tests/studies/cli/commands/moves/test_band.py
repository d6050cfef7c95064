"""A band in which the tip may act, by commands: the answer's first line, its range, its limit."""

import csv
import json
import re
import signal
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

import quietarm as qa
from quietarm.ocp import FIGURES, TimeFront
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.robustness import worst_of

PAPER = "single-link --target 30deg --duration 0.8 --coefficients=0.003347,-0.1697"
"""The paper's two terms, which leave 0.05 mm of the nominal plant."""


def test_the_first_line_says_when_the_tip_may_act_and_for_what(done):
    out = done(f"evaluate {PAPER} --band 2cm --error frequency=3% --output plan.json")
    plan = qa.Plan.load("plan.json")
    assert plan.task.band == 0.02
    first, *_ = out.splitlines()
    assert first == (
        f"may act after {plan.acts_after:.3g} s: within 20 mm for frequency errors up to 3 %"
    )
    assert 0.5 < plan.acts_after < 0.8  # before the motion's end
    stated = json.loads(Path("plan.json").read_text())["stated"]
    assert stated["acts_after"] == plan.acts_after == plan.figures["acts_after"]
    assert "acts after" in plan._repr_html_()


def test_without_an_error_the_range_is_five_percent_and_is_said(done):
    out = done(f"evaluate {PAPER} --band 1mm --output plan.json")
    assert "the band is for frequency errors up to 5 %, as no --error is given" in out
    assert qa.Plan.load("plan.json").task.ranges == {"frequency": 0.05}


def test_every_row_of_a_path_is_of_the_worst_of_its_scenarios(done, folder):
    rows = [f"{k / 10},{x}" for k, x in enumerate([0, 1, 3, 6, 8, 9, 9.5])]
    (folder / "path.csv").write_text("\n".join(["time_s,position_mm", *rows]))
    out = done("evaluate linear-axis --path path.csv --band 0.5mm --error frequency=20%")
    first = re.search(r"may act after ([0-9.]+) s: within 0.5 mm", out)[1]
    assert float(re.search(r"acts after +([0-9.]+) s", out)[1]) == pytest.approx(float(first), 5e-3)
    worst = re.search(r"residual +([0-9.]+) mm at the tip, worst of 3 scenarios", out)[1]
    at_ends = re.findall(r"residual +([0-9.]+) mm with frequency [-+]20 %", out)
    assert len(set(at_ends)) == 2
    assert worst == max(at_ends, key=float)


@pytest.mark.slow
def test_a_tip_that_nothing_damps_may_never_act(done):
    out = done(f"evaluate {PAPER} --set zeta=0 --band 0.1mm --output plan.json")
    assert out.startswith("may never act: the tip does not stay within 0.1 mm for frequency")
    assert "acts_after" not in qa.Plan.load("plan.json").figures


@pytest.mark.slow
def test_a_plant_without_a_place_of_its_tip_says_what_is_taken(done):
    line = "evaluate dual-link --target 30deg --duration 1.6 --coefficients=0,0 --band 50mm"
    out = " ".join(done(line).split())
    assert out.startswith("may act after 1.6 s")
    taken = "dual-link does not say where its tip goes with the joint, so that it is taken to "
    assert f"; {taken}arrive with it This motion takes " in out


LINE = "plan single-link --target 30deg --duration 1 --terms 6 --error frequency=1%"


def test_a_plan_keeps_a_share_of_the_band(done):
    done(f"{LINE} --band 3mm --margin 2 --output plan.json")
    plan = qa.Plan.load("plan.json")
    assert (plan.task.margin, plan.residual_limit) == (2.0, 1.5e-3)
    assert plan.worst.residual <= 1.501e-3


@pytest.mark.slow
def test_another_residual_limit_wins_and_that_is_said(done):
    out = done(f"{LINE} --band 3mm --residual-limit 2mm --output wide.json")
    assert "the residual limit is 2 mm, as stated, in place of the band's 1 mm" in out
    assert qa.Plan.load("wide.json").residual_limit == 2e-3


def test_a_task_without_a_band_has_no_place_for_it(done):
    out = done(f"evaluate {PAPER} --output plan.json")
    plan = qa.Plan.load("plan.json")
    assert "act" not in out.split()
    assert plan.acts_after != plan.acts_after  # no number
    text = Path("plan.json").read_text()
    assert not any(word in text for word in ("band", "margin", "acts_after"))
    assert "acts_after" in FIGURES


def test_a_plan_without_an_error_says_what_it_leaves_where_the_frequency_is_off(done):
    """The residuals are those of CVODES on the plants themselves."""
    out = done("plan single-link --target 30deg --duration 0.8 --output plan.json")
    motion = qa.Plan.load("plan.json").candidate
    worst = [
        1e3 * max(motion.perturbed({"frequency": sign * share}).residual for sign in (-1, 1))
        for share in (0.02, 0.05, 0.1)
    ]
    words = ", ".join(f"{size:.2g}" for size in worst)
    out = " ".join(out.split())
    assert f"if the frequency is 2, 5, 10 % off: {words} mm (ZV in the same time" in out
    assert "--error frequency=5% plans for that" in out
    assert "if the frequency" not in done(
        "plan single-link --target 30deg --duration 0.8 --terms 6 --error frequency=1%"
    )


@pytest.mark.slow
def test_a_front_begins_with_the_plan_for_its_band(done):
    """It keeps the band over its margin in all of the range, as a plan does, and acts first."""
    line = "front linear-axis --target 0.3 --duration 0.6 --terms 8 --points 3 --starts 1"
    lines = done(f"{line} --band 0.01mm --output front.json --quiet")
    out = " ".join(lines.split())
    front = qa.Front.load("front.json")
    motions = [front.judged(point) for point in front.points]
    first = min(motions, key=lambda motion: motion.acts_after)
    assert first.coefficients == motions[0].coefficients
    assert out.startswith(f"may act after {first.acts_after:.2g} s: within 0.01 mm")
    assert f", by {first.energy:.4g} J From " in out
    limit = front.task.band_limit
    assert worst_of(first).residual <= (1 + OVERRUN) * limit
    plan = qa.plan_move(front.task.with_samples([[-0.05], [0.05]]), front.profile, starts=1)
    assert first.energy == pytest.approx(plan.energy, rel=1e-3)
    assert len(front.task.scenarios) > 3
    worst = max(worst_of(motion).residual for motion in motions)
    inside = re.search(r"within it \d of \d+ leave more, at most ([\d.]+) mm", out)
    assert float(inside[1]) <= 1e3 * worst * (1 + 1e-3)
    assert "and 1 leave no more than 0.00333 mm, the band over its margin" in out


def test_what_is_not_feasible_names_the_band_that_was_typed(refused):
    line = "plan linear-axis --target 0.3 --duration 0.3 --terms 2 --starts 1 --quiet"
    said = refused(f"{line} --acceleration-limit 20 --band 0.1mm", status=1)
    assert "with residual <= 0.03333 mm (a band of 0.1 mm with a margin of 3), accel" in said
    assert re.search(r"unchanged: band [0-9.]+ mm", said)
    wider = float(re.search(r"band ([0-9.]+) mm;", said)[1])
    assert 1 < wider < 300


@pytest.mark.slow
def test_a_front_of_time_and_energy_says_what_a_millisecond_takes(done):
    line = "front single-link --target 30deg --band 5mm --error frequency=2% --jerk-limit 300"
    out = done(
        f"{line} --torque-limit 0.2 --objectives time,energy --points 3 --output t.json -o t.csv "
        "-o t.png --quiet"
    )
    front = TimeFront.load("t.json")
    assert len(front.points) == 3
    assert (front.times[1:] > front.times[:-1]).all()
    assert (front.energies[1:] < front.energies[:-1]).all()
    assert "a millisecond takes less than a joule in each of these durations" in out
    with Path("t.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["acts_after_s"]) for row in rows] == front.times.tolist()
    plan = front.plan_of(front.points[1])
    assert plan.acts_after == pytest.approx(front.points[1].acts_after, rel=1e-6)
    assert plan.energy == pytest.approx(front.points[1].energy, rel=1e-6)


@pytest.mark.slow
def test_a_fastest_move_without_a_jerk_limit_takes_one_and_says_so(done):
    out = done(
        "plan single-link --target 30deg --duration fastest --torque-limit 0.15 -o plan.json"
    )
    plan = qa.Plan.load("plan.json")
    assert plan.motion.peak_jerk <= 1.001 * plan.task.jerk_limit
    assert f"the jerk {plan.task.jerk_limit:g} rad/s^3 is taken, as none is given" in out
    assert "warning" not in out


@pytest.mark.parametrize("stopped_at", [1, 3])
def test_a_front_of_time_that_is_stopped_keeps_its_points(call, monkeypatch, stopped_at):
    line = (
        "front linear-axis --target 0.3 --duration 0.6 --acceleration-limit 9 --jerk-limit 900 "
        "--band 1mm --points 4 --objectives time,energy --output time.json --output time.csv"
    )
    asked = []

    def planned(task, *_, **__):
        asked.append(task)
        if len(asked) == stopped_at:
            raise KeyboardInterrupt(signal.SIGTERM)
        if len(asked) == 1:  # the fastest move
            task = replace(task, duration=0.4)
        plan = qa.evaluate_coefficients(task, [])
        return SimpleNamespace(plan=plan) if len(asked) == 1 else plan

    for name in ("fastest_move", "plan_move"):
        monkeypatch.setattr(f"quietarm.ocp.front.time_front.{name}", planned)
    code, _, err = call(f"{line} --quiet")
    assert code == 128 + signal.SIGTERM
    if stopped_at == 1:
        assert not Path("time.json").exists()
        return
    assert "interrupted: 2 of 4 points are found and kept" in err
    assert len(TimeFront.load("time.json").points) == 2
    assert len(Path("time.csv").read_text().splitlines()) == 1 + 2
