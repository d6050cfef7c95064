"""`quietarm identify`, and machines in the place of plants."""

import math
import re
from dataclasses import replace
from datetime import datetime, timedelta

import numpy as np
import pytest
from scipy.io import savemat

from quietarm.machine.identify import Identified
from quietarm.ocp import Plan

TIME = np.arange(0, 6, 0.005)
OMEGA, ZETA = 2 * math.pi * 3.2, 0.01
SWING = np.exp(-ZETA * OMEGA * TIME) * np.cos(OMEGA * math.sqrt(1 - ZETA**2) * TIME)
TIP = 20 * SWING + np.random.default_rng(0).standard_normal(len(TIME))  # mm
PUSH = "identify push.csv flexible-beam --quiet --tip tip_mm --assume all"


def write(path, tip):
    path.write_text("time_s,tip_mm\n" + rows("%.4g,%.2f\n", TIME, tip))


@pytest.fixture
def push(folder):
    write(folder / "push.csv", TIP)
    for k in range(2):
        noise = np.random.default_rng(k + 1).standard_normal(len(TIME))
        write(folder / f"again{k}.csv", 18 * SWING + noise)
    return folder


def test_pushes_make_a_machine_that_is_planned_for(push, done, refused):
    out = done(f"{PUSH} --set length=0.6 --output one.json")
    assert "One ring-down does not tell how much the machine varies" in out
    plan = "--quiet --set friction=0.02 --target 30deg --duration 1 --error measured"
    assert "one ring-down does not tell" in refused(f"plan one.json {plan}")
    line = PUSH.replace("push.csv", "push.csv again0.csv again1.csv")
    out = done(f"{line} --set length=0.6 --output arm.json --output fit.png")
    assert re.search(r"next swing +within 3\.", out)
    assert (push / "fit.png").read_bytes().startswith(b"\x89PNG")
    found = Identified.load(push / "arm.json")
    assert found.plant.length == 0.6
    out = done(f"plan arm.json {plan} --output plan.json")
    task = Plan.load(push / "plan.json").task
    # of a frequency 2 % at least, whatever the recordings of one hour show
    assert task.ranges == {**found.errors, "omega": 0.02} == found.ranges
    assert "% uncertain by the recordings, and 2 % here" in out
    assert (task.plant.friction, task.plant.omega) == (0.02, found.plant.omega)
    out = done("identify --check arm.json again1.csv --tip tip_mm --quiet")
    assert "of the swing predicted over five periods, at least" in out


@pytest.mark.slow
def test_a_band_is_for_the_interval_of_a_file_that_has_no_range_but_a_wide_one(push, done):
    done(f"{PUSH} --output one.json")
    one = Identified.load("one.json")
    wide = [
        replace(known, low=0.9 * known.value, high=1.1 * known.value) for known in one.estimates
    ]
    replace(one, estimates=tuple(wide)).save("wide.json")
    plan = "--quiet --target 30deg --duration 1 --band 1mm --output plan.json"
    for name, error in {"one": 0.05, "wide": 0.1}.items():
        done(f"plan {name}.json {plan}")
        assert Plan.load("plan.json").task.ranges == {"frequency": pytest.approx(error)}


@pytest.mark.slow
def test_another_tip_mass_keeps_the_measured_frequency_and_says_so(push, call, refused):
    call(f"{PUSH.replace('push.csv', 'push.csv again0.csv')} --output arm.json")
    beam = Identified.load(push / "arm.json").plant
    line = "plan arm.json --quiet --target 30deg --duration 1"
    code, _, err = call(f"{line} --set tip_mass=0.1 --output plan.json")
    assert (code, Plan.load("plan.json").task.plant.omega) == (0, beam.omega)
    loaded = beam.carrying(0.1).omega / math.tau
    assert "tip_mass is 0.1 kg, and was 0.036 kg" in err
    assert f"--set omega={loaded:.4g}Hz" in err
    for quiet in ("", "--set tip_mass=36g", "--set tip_mass=0.1 --set omega=2Hz"):
        assert call(f"{line} {quiet}")[2] == ""
    for name, value in {"omega": "3Hz", "tip_mass": "0.1", "length": "0.5"}.items():
        said = refused(f"{line} --set {name}={value} --error measured")
        assert f"the measured intervals are of the machine with {name} " in said
        assert "or state errors of your own, such as frequency=5%" in said
    said = refused("sweep arm.json --quiet --target 1 --duration 1 --set omega=3Hz,3.1Hz "
                   "--error measured --output m.zarr")  # fmt: skip
    assert "with omega" in said


def rows(form, *columns):
    return "".join(form % row for row in zip(*columns, strict=True))


TEXTS = {
    "klipper.csv": ("##errors=0\n#time,accel_x,accel_y\n", "%.3f,%.3f,0\n", 1e3,
                    "--acceleration accel_x --units acceleration:mm/s^2"),
    "labview.lvm": ("LabVIEW Measurement\n***End_of_Header***\nX_Value\tUntitled\tComment\n",
                    "%.3f\t%.3f\t\n", 1, "--tip Untitled --units tip:mm"),
    "scope.csv": ("Model,X1\nRecord length,1000\n\ntime,tip\n(s),(mm)\n", "%.3f,%.3f\n", 1,
                  "--tip tip"),
    "marked.txt": ("#my rig, push 1\n#time_s\ttip_mm\n", "%.3f\t%.3f\n", 1, "--tip tip_mm"),
    "trailing.csv": ("time_s,tip_mm,\n", "%.3f,%.3f,\n", 1, "--tip tip_mm"),
    "slash.csv": ("t/s;w/mm\n", "%.3f;%.3f\n", 1, "--tip w/mm"),
    "counts.csv": ("time_s,laser_counts\n", "%.3f,%.0f\n", 100,
                   "--tip laser_counts --scale tip=1e-5"),
    "numbers.dat": ("", "%.3f %.3f\n", 1, "--time 0 --tip 1 --units tip:mm"),
}  # fmt: skip


@pytest.mark.slow_after(4)
@pytest.mark.parametrize("name", TEXTS)
def test_texts_of_other_programs_tell_the_same(push, done, name):
    header, form, size, options = TEXTS[name]
    (push / name).write_text(header + rows(form, TIME, size * TIP))
    same(done, f"identify {name} flexible-beam {options}")


def same(done, line):
    assumed = "" if "--assume" in line else "--assume all"
    done(f"{line} {assumed} --quiet --output arm.json")
    omega, zeta = Identified.load("arm.json").estimates
    assert omega.low < OMEGA < omega.high, line
    assert zeta.value == pytest.approx(ZETA, rel=0.1)


@pytest.mark.slow
def test_arrays_and_german_texts_tell_the_same(push, done):
    np.save(push / "push.npy", np.column_stack([TIME, TIP]))
    savemat(push / "push.mat", {"t": TIME, "w": TIP, "rate": 200.0})
    savemat(push / "nested.mat", {"run": {"t": TIME, "X": np.column_stack([0 * TIP, TIP])}})
    (push / "german.csv").write_text((push / "push.csv").read_text().translate({44: 59, 46: 44}))
    milliseconds = rows("%.0f,%.2f\n", 1e3 * TIME, TIP)
    (push / "ms.csv").write_text(f"Time (ms),tip [mm]\n{milliseconds}")
    for line in (
        PUSH,
        "identify push.npy flexible-beam --time 0 --tip 1 --units tip:mm",
        "identify push.mat flexible-beam --tip w",
        "identify nested.mat flexible-beam --time run.t --tip run.X:2",
        "identify german.csv flexible-beam --tip tip_mm",
        "identify ms.csv flexible-beam --tip tip",
        "identify push.csv ms.csv flexible-beam --time 0 --tip 1",
    ):
        same(done, line)


def test_a_swing_that_no_arm_has_is_asked_about(push, refused):
    (push / "slow.csv").write_text("time,tip_mm\n" + rows("%.0f,%.2f\n", 1e3 * TIME, TIP))
    assert "Hz, as no arm does" in refused("identify slow.csv flexible-beam --tip tip_mm")


@pytest.mark.slow
def test_one_column_for_two_signals_and_degrees_called_radians_are_told(push, call, refused):
    said = refused("identify push.csv flexible-beam --tip tip_mm --angle 1")
    assert "column tip_mm is given for two signals; give each a column of its own" in said
    angle = 60 * np.clip(TIME - 1, 0, 1)
    columns = rows("%.4g,%.4g,%.2f\n", TIME, angle, TIP)
    (push / "turned.csv").write_text(f"time_s,theta_rad,tip_mm\n{columns}")
    line = "identify turned.csv flexible-beam --tip tip_mm --angle theta_rad --quiet"
    _, said, _ = call(line)
    assert "turns by 60 rad, more than two turns; is it in degrees?" in said
    assert "is it in degrees?" not in call(f"{line} --units angle:deg")[1]
    (push / "turned.csv").write_text(f"time_s,theta_deg,tip_mm\n{columns}")
    assert "is it in degrees?" not in call(line.replace("theta_rad", "theta_deg"))[1]


def clock(form, late=0.0):
    """Times of day of the rows, from four minutes before a full hour on."""
    day = datetime(2026, 3, 4, 23, 59, 58)
    return [(day + timedelta(seconds=t + late)).strftime(form) for t in TIME]


SINCE = 1e3 * TIME + 401233.0
RECORDERS = {
    "clock.csv": ("timestamp,tip_mm\n", "%s,%.3f\n", (clock("%Y-%m-%d %H:%M:%S.%f"), TIP), ""),
    "day.txt": ("Clock\ttip_mm\n", "%s\t%.3f\n", (clock("%H:%M:%S.%f"), TIP), "--time Clock"),
    "iso.csv": ("time;tip_mm\n", "%sZ;%.3f\n", (clock("%Y-%m-%dT%H:%M:%S.%f"), TIP), ""),
    "noon.csv": ("time;tip_mm\n", "%s;%.3f\n", (clock("%m/%d/%Y %I:%M:%S.%f %p"), TIP), ""),
    "commas.csv": ("time_ms;tip_um\n", "%s;%s\n",
                   ([f"{1e3 * t:.1f}" for t in TIME], [f"{1e3 * w:,.1f}" for w in TIP]), ""),
    "points.csv": ("time_ms;tip_um\n", "%s;%s\n",
                   ([f"{1e3 * t:.1f}".replace(".", ",") for t in TIME],
                    [f"{1e3 * w:,.2f}".translate({44: 46, 46: 44}) for w in TIP]), ""),
    "spaces.csv": ("time_ms;tip_um\n", "%s;%s\n",
                   ([f"{1e3 * t:.1f}" for t in TIME],
                    [f"{1e3 * w:,.1f}".replace(",", "\u202f") for w in TIP]), ""),
    "quoted.csv": ("time_ms,tip_um\n", '%s,"%s"\n',
                   ([f"{1e3 * t:.1f}" for t in TIME], [f"{1e3 * w:,.1f}" for w in TIP]), ""),
    "labview.lvm": ("LabVIEW Measurement\t\nSamples\t1200\t\n***End_of_Header***\t\t\n"
                    "X_Value\ttip_mm\tComment\n", "%.3f\t%.4f\n", (TIME, TIP), ""),
    "first.csv": ("sample,tip_mm\n", "%.3f,%.4f\n", (TIME, TIP), ""),
    "bare.txt": ("", "%.3f %.4f\n", (TIME, TIP), "--tip 1 --units tip:mm"),
    "since.txt": ("%%Time (s)\ttip_mm(m)\ttau[3]\n", "%.3f\t%.5f\t%.1f\n", (SINCE, TIP / 1e3, TIP),
                  "--time 0 --tip tip_mm --units time:ms"),
    "index.csv": ("time_s,tip[3]\n", "%.3f,%.4f\n", (TIME, TIP), "--tip tip[3] --units tip:mm"),
    "one.txt": ("angle, rate\n4, 200\n", "%.3f\n", (TIP,), "--tip 0 --rate 200"),
    "named.txt": ("tip_mm\n", "%.3f\n", (TIP,), "--rate 0.2kHz"),
    "counts.csv": ("time_ms,tip_counts\n", "%.1f,%.0f\n", (1e3 * TIME, 100 * TIP),
                   "--tip tip_counts --scale time=1e-3,tip=1e-5"),
    "bars.txt": ("time (min)|load|tip (mm)\n", "%.8f|1|%.4f\n", (TIME / 60, TIP),
                 "--time 0 --tip 2"),
    "frame.txt": ("| time [minutes] | tip [mm] |\n|---|---:|\n", "| %.8f | %.4f |\n",
                  (TIME / 60, TIP), "--time 0 --tip 1"),
    "query.txt": (" time_min | tip_mm \n----------+--------\n", " %.8f | %.4f\n",
                  (TIME / 60, TIP), "--time 0 --tip 1"),
    "apart.txt": ("# Time (min) Load (N) Tip (mm)\n", "%.8f 1 %.4f\n", (TIME / 60, TIP),
                  "--time 0 --tip 2"),
    "words.txt": ("Time since start (min) Tip deflection (mm)\n", "%.8f %.4f\n",
                  (TIME / 60, TIP), "--time 0 --tip 1"),
    "mixed.txt": ("Time [ms], Tip [mm]\n", "%.1f %.4f\n", (1e3 * TIME, TIP), "--time 0 --tip 1"),
}  # fmt: skip


@pytest.mark.slow_after(6)
@pytest.mark.parametrize("name", RECORDERS)
def test_files_of_recorders_tell_the_same(push, done, name):
    header, form, columns, options = RECORDERS[name]
    (push / name).write_text(header.replace("%%", "%") + rows(form, *columns), encoding="utf-8")
    tip = "" if "--tip" in options else f"--tip {'tip_um' if 'tip_um' in header else 'tip_mm'}"
    same(done, f"identify {name} flexible-beam {tip} {options}")


@pytest.mark.parametrize(
    "footer", ["({count} rows)", "{count} rows in set (0.02 sec)", "({count} rows affected)"]
)
def test_the_count_of_rows_below_a_query_is_refused_with_its_line(push, refused, footer):
    header, form, columns, options = RECORDERS["query.txt"]
    below = footer.format(count=len(TIME))
    text = f"{header}{rows(form, *columns)}{below}\n\n"
    (push / "query.txt").write_text(text)
    said = refused(f"identify query.txt flexible-beam {options}")
    number = text.splitlines().index(below) + 1
    assert f"line {number}: '{below}' is no number; mend it, or leave the cell empty" in said


@pytest.mark.slow
def test_signals_of_a_simulink_structure_go_by_their_labels(push, done, refused):
    signals = np.array([(TIP[:, None], "tip_mm"), (0 * TIP, "theta")],
                       dtype=[("values", object), ("label", object)])  # fmt: skip
    savemat(push / "scope.mat", {"Scope": {"time": TIME[:, None], "signals": signals}})
    same(done, "identify scope.mat flexible-beam --tip tip_mm")
    same(done, "identify scope.mat flexible-beam --tip Scope.tip_mm --time Scope.time")
    said = refused("identify scope.mat flexible-beam --tip w")
    assert "by number from 0, are Scope.time, Scope.tip_mm, Scope.theta" in said


@pytest.mark.slow
def test_columns_of_a_matrix_are_listed_by_name_in_every_message(push, refused):
    savemat(push / "matrix.mat", {"X": np.stack([0 * TIME, TIP], axis=1)})
    for tip in ("w", "X:2"):  # no such column; no time
        said = refused(f"identify matrix.mat flexible-beam --tip {tip}")
        assert "its columns, by name or by number from 0, are X:1, X:2" in said


def test_a_first_column_that_counts_rows_is_no_time(push, refused):
    (push / "counted.csv").write_text("row,tip_mm\n" + rows("%d,%.3f\n", range(len(TIP)), TIP))
    said = refused("identify counted.csv flexible-beam --tip tip_mm")
    assert "or give the samples per second by --rate" in said


def test_output_has_a_short_name(push, done):
    done(f"{PUSH} --set length=0.6 -o short.json")
    done(f"{PUSH} --set length=0.6 --output long.json")
    assert Identified.load("short.json") == Identified.load("long.json")


@pytest.mark.slow
def test_words_tell_from_which_amplitude_on_a_swing_is_fitted(push, done):
    t = np.arange(0, 60, 0.01)
    size = 20 * np.exp(-0.05 * t)
    phase = 2 * math.pi * np.cumsum(2.0 - 0.1 * (size / 20) ** 2) * 0.01
    (push / "hard.csv").write_text("time_s,tip_mm\n" + rows("%.2f,%.4f\n", t, size * np.cos(phase)))
    out = " ".join(
        done("identify hard.csv flexible-beam --tip tip_mm --assume all -o hard.json").split()
    )
    assert "fitted from an amplitude of" in out
    assert "The intervals hold for this swing, not for a larger one" in out
    omega = Identified.load("hard.json").estimates[0]
    assert omega.low < 2 * math.pi * 1.91 < 2 * math.pi * 1.995 < omega.high


# What neither recordings nor the user tell


@pytest.fixture
def ring_downs(folder):
    """Two ring-downs of a gantry: 4.5 Hz, 0.007, with its position in mm and its force."""
    omega = 2 * math.pi * 4.5
    for k in range(2):
        noise = np.random.default_rng(k).normal(0, 0.02, len(TIME))
        tip = (8 + k) * np.exp(-0.007 * omega * TIME) * np.cos(omega * TIME) + noise
        (folder / f"ring{k}.csv").write_text(
            "time_s,tip_mm,axis_mm,force_N\n"
            + rows("%.4g,%.4f,%.3f,%.2f\n", TIME, tip, 0 * tip, tip)
        )
    return folder


GANTRY = "identify ring0.csv ring1.csv linear-axis --quiet --tip tip_mm"


def test_a_machine_has_nothing_of_the_class_that_nobody_told(ring_downs, done, refused):
    said = refused(f"{GANTRY} --output axis.json --output fit.svg")
    assert "the recordings do not tell share1, mass, load, friction" in said
    assert "give each by --set, such as --set share1=..." in said
    assert not (ring_downs / "axis.json").exists()
    out = done(f"{GANTRY} --output fit.svg")
    assert re.search("default +share1 1, mass 8 kg, load 2 kg, friction 5 N s/m", out)
    weighed = "--set mass=82.7kg --set load=15kg --set friction=50"
    done(f"{GANTRY} {weighed} --assume share1 --output axis.json")
    plant = Identified.load("axis.json").plant
    assert (plant.mass, plant.load, plant.friction, plant.share1) == (82.7, 15, 50, 1)
    assert plant.omega1 == pytest.approx(2 * math.pi * 4.5, rel=1e-3)
    assert plant.zeta1 == pytest.approx(0.007, rel=0.02)


@pytest.mark.parametrize(
    ("plant", "given", "lacks"),
    [
        ("single-link", "", "alpha1, alpha2, c, beta1, beta2, phi"),
        ("flexible-beam", "", "hub_inertia, friction, length, mass_per_length, tip_mass, hub_r"),
        ("flexible-beam", "--set length=1 --set hub_radius=0", "hub_inertia, friction, mass_"),
        ("arm-on-flexible-link", "", "alpha1, alpha2, alpha3, alpha4, beta1, beta2, beta3, c, phi"),
        ("linear-axis", "--assume mass,load,friction", "share1,"),
        ("linear-axis", "--free omega1 --set zeta1=0.01", "share1, mass, load, friction"),
        ("linear-axis", "--free omega1", "zeta1, share1, mass, load, friction"),
    ],
)  # fmt: skip
def test_each_parameter_that_is_not_told_is_named(ring_downs, refused, plant, given, lacks):
    line = GANTRY.replace("linear-axis", plant)
    said = refused(f"{line} {given} --output axis.json")
    assert f"the recordings do not tell {lacks}" in said


def test_a_frequency_or_damping_cannot_be_assumed(ring_downs, refused, call):
    said = refused(f"{GANTRY} --assume zeta1 --output axis.json")
    assert "--assume zeta1: a ring-down tells it" in said
    said = refused(f"{GANTRY} --free omega1 --assume all --output axis.json")
    assert "do not tell zeta1, and" in said
    assert "give each by --set, such as --set zeta1=..." in said
    out = call(f"{GANTRY} --set omega1=12Hz --assume all --output axis.json")[1]
    assert "--set omega1 is not used, because the recordings tell its value" in out


def test_plants_of_ones_own_have_values_of_ones_own(ring_downs, done):
    (ring_downs / "mine.py").write_text(
        "from dataclasses import dataclass\nfrom quietarm.models import LinearAxis\n"
        "@dataclass(frozen=True)\nclass Mine(LinearAxis):\n    name = 'mine'\n"
        "    mass: float = 90.0\n"
    )
    line = GANTRY.replace("linear-axis", "mine --plant-file mine.py")
    done(f"{line} --output axis.json")
    assert (ring_downs / "axis.json").exists()


# Units by the kind of joint, and columns


def test_the_position_of_a_linear_axis_is_a_length_and_its_drive_a_force(ring_downs, done, refused):
    out = done(f"{GANTRY} --angle axis_mm --assume all")
    assert "ring0.csv, ring1.csv: not used: column force_N" in out
    assert "omega1" in out
    assert "mm' of column axis_mm is a unit of length, and not of angle" in refused(
        f"{GANTRY} --angle axis_mm".replace("linear-axis", "flexible-beam")
    )
    assert "'N' of column force_N is a unit of force, and not of torque" in refused(
        f"{GANTRY} --torque force_N".replace("linear-axis", "flexible-beam")
    )
    assert "'deg' of column axis_mm is a unit of angle, and not of length" in refused(
        f"{GANTRY} --angle axis_mm --units angle:deg"
    )
    done(f"{GANTRY} --angle axis_mm --units angle:um")
    done(f"{GANTRY} --angle axis_mm --scale angle=1e-3")
    said = refused(f"{GANTRY} --angle tip_mm --tip axis_mm --units angle:m")
    assert "is it in millimetres?" not in said
    (ring_downs / "far.csv").write_text(
        "time_s,tip_mm,axis\n" + rows("%.4g,%.4f,%.3f\n", TIME, TIP, 800 + 0 * TIME)
    )
    said = refused("identify far.csv linear-axis --tip tip_mm --angle axis")
    assert "a position of 800 m; is it in millimetres? say so by --units angle:mm" in said


def test_what_is_given_twice_or_for_nothing_is_refused(ring_downs, refused):
    assert "--angle is given 2 times" in refused(f"{GANTRY} --angle axis_mm --angle force_N")
    assert "--units has torque, and no column of it" in refused(f"{GANTRY} --units torque:N")
    assert "--scale has angle, and no column of it" in refused(f"{GANTRY} --scale angle=2")
    twice = (ring_downs / "ring0.csv").read_text().replace("axis_mm", "tip_mm")
    (ring_downs / "ring0.csv").write_text(twice)
    assert "2 columns are called 'tip_mm'; give one's number, 1 or 2" in refused(GANTRY)


def test_an_unknown_unit_and_columns_of_no_use_are_named(push, done):
    (push / "odd.csv").write_text(
        "time_cs,tip_mm,load,note\n" + rows("%.3f,%.3f,%.1f,ok\n", TIME, TIP, TIP)
    )
    out = done("identify odd.csv flexible-beam --tip tip_mm")
    assert "odd.csv: not used: columns load, note" in out
    assert "'cs' in column time_cs is not a known unit, so its values are read in s" in out


@pytest.mark.slow_after(2)
@pytest.mark.parametrize("heading", ["micros", "time_us", "micros()", "Time (us)"])
def test_a_counter_of_a_small_board_that_wraps_is_unwrapped(push, done, heading):
    ticks = (np.round(1e6 * TIME) + 2**32 - 3_000_000) % 2**32
    (push / "board.csv").write_text(f"{heading},tip_mm\n" + rows("%.0f,%.3f\n", ticks, TIP))
    same(done, "identify board.csv flexible-beam --tip tip_mm")
    out = done("identify board.csv flexible-beam --tip tip_mm")
    assert "board.csv: its clock, a counter of 32 bits, wraps after row 600" in " ".join(
        out.split()
    )


def test_milliseconds_of_a_counter_of_microseconds_wrap_with_it(push, done):
    ticks = (np.round(1e6 * TIME) + 2**32 - 3_000_000) % 2**32 // 1000
    (push / "board.csv").write_text("millis,tip_mm\n" + rows("%.0f,%.3f\n", ticks, TIP))
    same(done, "identify board.csv flexible-beam --tip tip_mm")


def test_a_file_of_two_recordings_is_named(push, refused):
    rest = (push / "again0.csv").read_text().partition("\n")[2]
    (push / "push.csv").write_text((push / "push.csv").read_text() + rest)
    said = refused(PUSH)
    assert "push.csv: two recordings, the second from row 1201: give them as two files" in said


# A machine that predicts nothing


@pytest.mark.parametrize(
    ("hertz", "zeta", "why"),
    [(3.6, ZETA, "swings at 3.6 Hz, and the machine at 3.2"), (3.2, 0.4, "its damping is 0.")],
)
def test_a_check_that_predicts_nothing_is_an_error_with_its_cause(push, call, hertz, zeta, why):
    call(f"{PUSH} --output arm.json")
    omega = 2 * math.pi * hertz
    since = np.maximum(TIME - 0.5, 0)
    tip = 20 * np.exp(-zeta * omega * since) * np.cos(omega * math.sqrt(1 - zeta**2) * since)
    write(push / "other.csv", tip + np.random.default_rng(5).normal(0, 0.02, len(TIME)))
    code, out, err = call("identify --check arm.json other.csv --tip tip_mm --quiet")
    assert code == 2
    assert "of the swing predicted" in out
    assert "predicts nothing of other.csv" in err
    assert why in err
