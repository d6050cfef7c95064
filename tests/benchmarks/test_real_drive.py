"""benchmarks/real_drive.py: the physics of its simulator, and the tables of docs/drive*.md."""

import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "benchmarks"))

import real_drive  # noqa: E402
from parts.drive import page  # noqa: E402
from parts.drive.beam import Beam, Lump, tuned  # noqa: E402
from parts.drive.machines import GANTRY, PICKER, Friction  # noqa: E402
from parts.drive.measures import outcomes  # noqa: E402
from parts.drive.moves import MOVES, plan, shaper_over_ruckig  # noqa: E402
from parts.drive.recordings import LOCKED, identified  # noqa: E402
from parts.drive.simulate import TICKS, SetPoints, simulate  # noqa: E402

NOTHING = Friction(0.0, 0.0, 0.0)
ROD = Beam(length=2.0, stiffness=30.0, line_mass=0.4, lumps=(Lump(1.0, 0.0),))
CLAMPED = (1.875104, 4.694091, 7.854757)
"""Roots of cos(x) cosh(x) = -1: the clamped beam with a free end."""


def smooth(way, duration, rows=400):
    """A plain cycloid as set points."""
    phase = np.linspace(0, 1, rows + 1)
    turn = 2 * np.pi * phase
    return SetPoints(
        phase * duration,
        way * (phase - np.sin(turn) / (2 * np.pi)),
        way / duration * (1 - np.cos(turn)),
        way / duration**2 * 2 * np.pi * np.sin(turn),
    )


def still(seconds=0.1):
    return SetPoints(np.array([0.0, seconds]), *np.zeros((3, 2)))


def without_servo(machine):
    return replace(machine, servo=replace(machine.servo, largest=0.0))


def pushed(machine, force):
    """A machine whose motor gives no force, pushed at its tool by a force over time."""
    count = len(force)
    rest = count / TICKS - 0.1
    return simulate([machine], [still()], rest=rest, push=np.asarray(force)[:, None])


@pytest.mark.parametrize("name", ["beam", "machines", "simulate", "measures"])
def test_the_simulator_shares_no_equation_with_quietarm(name):
    text = (ROOT / "benchmarks" / "parts" / "drive" / f"{name}.py").read_text()
    assert re.findall(r"^\s*(?:from|import) (quietarm|casadi|\.moves)", text, re.MULTILINE) == []


# The structure


def test_a_beam_has_the_frequencies_of_the_closed_form():
    omega, _ = ROD.modes(3)
    by_hand = np.array(CLAMPED) ** 2 * np.sqrt(30.0 / (0.4 * 2.0**4))
    assert omega == pytest.approx(by_hand, rel=3e-5)


def test_a_heavy_tool_swings_as_a_mass_on_the_spring_of_its_beam():
    heavy = replace(ROD, lumps=(Lump(1.0, 80.0),))
    (omega,), _ = heavy.modes(1)
    # Rayleigh: 33/140 of the beam moves with the tool
    assert omega == pytest.approx(np.sqrt(3 * 30.0 / (2.0**3 * (80 + 33 / 140 * 0.8))), rel=1e-5)


@pytest.mark.parametrize("machine", [GANTRY, PICKER], ids=lambda machine: machine.name)
def test_twice_as_many_elements_change_no_mode(machine):
    coarse, _ = machine.beam.modes(4)
    fine, _ = replace(machine.beam, elements=2 * machine.beam.elements).modes(4)
    assert fine == pytest.approx(coarse, rel=1e-4)


@pytest.mark.slow
def test_the_tool_sags_as_far_as_the_spring_of_a_clamped_beam():
    """Belt, play and beam are springs in a row; the force is held by the brake."""
    machine = replace(
        without_servo(GANTRY),
        motor_friction=LOCKED,
        guide_friction=Friction(0.0, 0.0, 5e3),
        backlash=2e-3,
        damping=(0.7, 0.7, 0.7, 0.7),
    )
    force = 50 * np.minimum(np.arange(2400) / 1500, 1)
    runs = pushed(machine, force)
    beam = machine.beam
    # the last of four modes leave out a thousandth of the compliance
    expected = 50 / machine.belt + 1e-3 + 50 * beam.length**3 / (3 * beam.stiffness)
    assert runs.tool[-1, 0] == pytest.approx(expected, rel=2e-3)


# Dry friction


def rigid(**changes):
    """A picker whose gripper hardly bends, with the same friction at standstill as sliding."""
    beam = tuned(900.0, PICKER.beam)
    return replace(without_servo(PICKER), beam=beam, motor_friction=NOTHING, **changes)


def test_a_body_sticks_until_it_is_pushed_harder_than_it_rubs():
    machine = rigid(guide_friction=Friction(5.0, 8.0, 0.0))
    force = np.minimum(0.01 * np.arange(1200), 9.0)
    runs = pushed(machine, force)
    assert np.abs(runs.motor[force < 7.9]).max() < 1e-7
    assert runs.motor[-1, 0] > 1e-3  # 4 N over 6 kg in 0.1 s


def test_a_body_slides_as_far_as_its_kinetic_energy_takes_it():
    machine = rigid(guide_friction=Friction(6.0, 6.0, 0.0))
    mass = machine.commissioned_mass
    time = 0.1
    force = np.where(np.arange(1800) < time * TICKS, 24.0, 0.0)
    runs = pushed(machine, force)
    speed = (24.0 - 6.0) / mass * time
    way = speed * time / 2 + speed**2 / (2 * 6.0 / mass)
    assert runs.motor[-1, 0] == pytest.approx(way, rel=1e-3)
    assert runs.motor[-1, 0] == pytest.approx(runs.motor[-100, 0], abs=1e-6)  # it has stopped


@pytest.mark.parametrize("machine", [GANTRY, PICKER], ids=lambda machine: machine.name)
@pytest.mark.parametrize("rubs", [False, True])
def test_what_the_motor_gives_is_what_moves_and_what_rubs(machine, rubs):
    """Without viscous damping the energy of the machine is the motor's work less dry friction."""
    dry = Friction(20.0, 30.0, 0.0) if rubs else NOTHING
    machine = replace(
        machine,
        damping=(0.0, 0.0, 0.0, 0.0),
        belt_damping=0.0,
        motor_friction=dry,
        guide_friction=dry,
    )
    runs = simulate([machine], [smooth(0.2, 0.25)], rest=-0.05)  # it ends in full motion
    mass, _, stiffness, _ = machine.matrices()
    places, speeds = np.split(runs.states[0], 2)
    stored = (speeds @ mass @ speeds + places @ stiffness @ places) / 2
    given = runs.work.sum() + runs.friction_work.sum()
    assert given == pytest.approx(stored, rel=1e-9)
    lost = -runs.friction_work.sum()
    assert lost > 3.9 if rubs else lost == 0  # at least 20 N over 0.2 m


# The servo, and the march


def test_the_force_comes_as_late_as_the_dead_time():
    late = [replace(PICKER, servo=replace(PICKER.servo, delay=delay)) for delay in (0, 1, 6)]
    runs = simulate(late, [smooth(0.05, 0.2)] * 3, rest=-0.15)
    first = [int(np.flatnonzero(runs.force[:, case])[0]) for case in range(3)]
    assert [tick - first[0] for tick in first] == [0, 1, 6]


def test_the_motor_keeps_to_what_the_drive_can_do():
    weak = replace(PICKER, servo=replace(PICKER.servo, largest=60.0))
    runs = simulate([weak], [smooth(0.1, 0.2)], rest=-0.1)  # the move asks for 94 N
    assert np.abs(runs.force).max() == 60.0


def test_an_encoder_sees_nothing_within_its_step():
    """A push that moves the axis by less than half a step meets no force of the servo."""
    loose = replace(
        PICKER, servo=replace(PICKER.servo, quantum=1e-2), motor_friction=NOTHING,
        guide_friction=NOTHING,
    )  # fmt: skip
    runs = pushed(loose, np.full(400, 1.0))  # 1 N over 6 kg: 0.8 mm in 0.1 s
    assert not runs.force.any()
    fine = pushed(replace(loose, servo=PICKER.servo), np.full(400, 1.0))
    assert np.abs(fine.motor).max() < 0.1 * np.abs(runs.motor).max()


@pytest.mark.slow
@pytest.mark.parametrize("machine", [GANTRY, PICKER], ids=lambda machine: machine.name)
def test_half_the_step_changes_the_tool_by_a_hundredth_of_the_band(machine):
    asked = [smooth(0.05, 0.25)]
    coarse = simulate([machine], asked, rest=0.0)
    fine = simulate([machine], asked, rest=0.0, steps=8)
    assert np.abs(fine.tool - coarse.tool).max() < 0.01 * real_drive.BAND


@pytest.mark.slow
def test_cases_beside_each_other_do_not_disturb_each_other():
    other = replace(GANTRY, backlash=1e-4, tool=1.2)
    asked = smooth(0.05, 0.1)
    alone = simulate([GANTRY], [asked], rest=0.1)
    beside = simulate([other, GANTRY], [smooth(0.1, 0.2), asked], rest=0.0)
    assert beside.tool[:, 1] == pytest.approx(alone.tool[:, 0], abs=1e-9)
    assert np.abs(beside.tool[:, 0] - beside.tool[:, 1]).max() > 0.01


# The published runs, and the page


@pytest.fixture(scope="module")
def runs():
    return page.Runs()


BOTH = pytest.mark.parametrize("machine", ["gantry", "picker"])


def test_the_pages_are_those_of_their_runs():
    assert "drive" in page.PAGES
    for name, place in page.PAGES.items():
        assert place.read_text() == page.written(name), name


@BOTH
def test_a_robust_plan_stays_within_the_band_where_one_without_an_error_does_not(runs, machine):
    for motion in ("robust", "robust, sooner"):
        for size in ("0", "0.02", "0.05"):
            assert all(row.stays for row in runs.off(machine, motion, size))
    for row in runs.off(machine, "nominal", "0.02"):
        assert row.acts_after_s == np.inf
    zvd = runs.base(machine, "ZVD")
    robust = runs.base(machine, "robust")
    assert robust.energy_j < 0.85 * zvd.energy_j
    assert zvd.acts_after_s < robust.acts_after_s  # what the page says that quietarm loses
    assert runs.base(machine, "robust, sooner").acts_after_s < zvd.acts_after_s


@BOTH
def test_a_third_of_the_band_is_the_least_margin_that_always_holds(runs, machine):
    """At every band, way to record and machine; a half of it is not always enough."""
    for way in ("on the way", "brake"):
        for band in (0.05, 0.1, 0.2, 0.5):
            assert runs.used(machine, way, band, 3) < 0.9
            assert runs.used(machine, way, band, 1) > 1
    assert max(runs.used(each, "on the way", 0.05, 2) for each in MOVES) > 1
    assert len(runs.quiet(machine, 1)) == 0
    assert len(runs.quiet(machine, 2)) < len(runs.quiet(machine, 3))


@BOTH
def test_a_recording_on_the_way_is_the_best_for_a_plan_without_an_error(runs, machine):
    nominal = runs.where(machine=machine, study="recording", motion="nominal")
    best = min(nominal, key=lambda row: row.farthest_mm)
    assert best.recorded == "on the way"
    others = [row.farthest_mm for row in nominal if row is not best]
    assert min(others) > 5 * best.farthest_mm
    robust = runs.where(machine=machine, study="recording", motion="robust")
    assert all(row.stays for row in robust)


def test_the_last_sentences_of_the_margin_are_those_of_the_runs(runs):
    extra = set(runs.quiet("gantry", None)) - set(runs.quiet("gantry", 3))
    assert extra == {"servo 20"}
    for machine in MOVES:
        for way in ("on the way", "brake"):
            assert runs.used(machine, way, 0.5, 2) < 1


@BOTH
def test_every_motion_leaves_the_band_where_the_drive_is_bad(runs, machine):
    leaving = {"dead time": "8", "encoder": "5e-05", "backlash": "0.0002"}
    for study, value in leaving.items():
        if study != "backlash":
            assert runs.hunts(machine, study, value)
        rows = runs.where(machine=machine, study=study, value=value)
        assert not any(row.stays for row in rows)


@pytest.mark.slow
@BOTH
def test_a_published_run_is_made_again(runs, machine):
    move = MOVES[machine]
    row = runs.base(machine, "robust")
    model = (row.frequency_hz, row.damping)
    again = identified("on the way", move, move.machine)
    assert again[:2] == pytest.approx(model, rel=2e-3)
    task = move.task(*model, row.duration_s, real_drive.RANGE)
    motions = {
        "robust": plan(task, real_drive.LIMIT),
        "ZVD": shaper_over_ruckig(move.task(*model, row.duration_s), "zvd"),
    }
    asked = list(motions.values())
    machines = [move.machine] * len(asked)
    found = outcomes(simulate(machines, asked), machines, asked, [real_drive.BAND] * len(asked))
    for name, outcome in zip(motions, found, strict=True):
        published = runs.base(machine, name)
        assert outcome.acts_after == pytest.approx(published.acts_after_s, abs=2e-3)
        assert 1e3 * outcome.farthest == pytest.approx(published.farthest_mm, abs=5e-3)
        assert outcome.energy == pytest.approx(published.energy_j, rel=1e-2)
