"""`quietarm identify`, and machines in the place of plants."""

import math
from datetime import datetime, timedelta

import numpy as np
import pytest
from scipy.io import savemat

from quietarm.ocp import Plan
from quietarm.studies.identify import Identified

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
    assert "of the next swing within 3." in out
    assert (push / "fit.png").read_bytes().startswith(b"\x89PNG")
    found = Identified.load(push / "arm.json")
    assert found.plant.length == 0.6
    done(f"plan arm.json {plan} --output plan.json")
    task = Plan.load(push / "plan.json").task
    assert task.ranges == found.errors
    assert (task.plant.friction, task.plant.omega) == (0.02, found.plant.omega)
    out = done("identify --check arm.json again1.csv --tip tip_mm --quiet")
    assert "of the swing predicted over five periods, at least" in out


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
        assert "or state errors of your own, as frequency=5%" in said
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


@pytest.mark.parametrize("name", RECORDERS)
def test_files_of_recorders_tell_the_same(push, done, name):
    header, form, columns, options = RECORDERS[name]
    (push / name).write_text(header.replace("%%", "%") + rows(form, *columns), encoding="utf-8")
    tip = "" if "--tip" in options else f"--tip {'tip_um' if 'tip_um' in header else 'tip_mm'}"
    same(done, f"identify {name} flexible-beam {tip} {options}")


@pytest.mark.parametrize(
    "footer", ["({count} rows)", "{count} rows in set (0.02 sec)", "({count} rows affected)"]
)
def test_the_count_of_rows_below_a_query_is_no_row(push, done, footer):
    header, form, columns, options = RECORDERS["query.txt"]
    below = footer.format(count=len(TIME))
    (push / "query.txt").write_text(f"{header}{rows(form, *columns)}{below}\n\n")
    same(done, f"identify query.txt flexible-beam {options}")


def test_signals_of_a_simulink_structure_go_by_their_labels(push, done, refused):
    signals = np.array([(TIP[:, None], "tip_mm"), (0 * TIP, "theta")],
                       dtype=[("values", object), ("label", object)])  # fmt: skip
    savemat(push / "scope.mat", {"Scope": {"time": TIME[:, None], "signals": signals}})
    same(done, "identify scope.mat flexible-beam --tip tip_mm")
    same(done, "identify scope.mat flexible-beam --tip Scope.tip_mm --time Scope.time")
    said = refused("identify scope.mat flexible-beam --tip w")
    assert "by number from 0, are Scope.time, Scope.tip_mm, Scope.theta" in said


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
