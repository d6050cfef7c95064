"""`quietarm learn`: the next plan from a recording, in files."""

import math
import re

import numpy as np
import pytest

import quietarm as qa
from quietarm.machine.identify import Identified
from quietarm.models import LinearAxis

AXIS = LinearAxis(omega1=2 * np.pi * 5, zeta1=0.01, mass=60.0, load=12.0, friction=40.0)
TASK = qa.PointToPoint(AXIS, target=0.5, duration=0.7)


@pytest.fixture(scope="module")
def plan():
    return qa.plan_move(TASK, qa.CycloidPolynomial(4), starts=1)


@pytest.fixture
def files(folder, plan):
    """A plan, and the recording of it on an axis that swings at 5.4 Hz, by CVODES."""
    plan.save(folder / "plan.json")
    actual = LinearAxis(omega1=2 * np.pi * 5.4, zeta1=0.01, mass=60.0, load=12.0, friction=40.0)
    task = qa.PointToPoint(actual, target=0.5, duration=0.7)
    moved = qa.evaluate_coefficients(task, plan.coefficients, profile=plan.profile)
    since = np.arange(0, 2.2, 0.002)
    run = moved.sampled(since)
    time = np.concatenate([np.arange(-0.2, 0, 0.002), since])
    rest = np.zeros(100)
    tip = 1e3 * np.concatenate([rest, run.joint[:, 0] + run.tips[:, 0]])
    tip += np.random.default_rng(0).normal(0, 0.01, len(tip))
    axis = 1e3 * np.concatenate([rest, run.joint[:, 0]])
    force = np.concatenate([rest, run.torque])
    table = np.c_[time + 3, tip, axis, force]
    header = "time_s,tool_mm,axis_mm,force_N"
    np.savetxt("run.csv", table, "%.6g", delimiter=",", header=header, comments="")
    return run


LINE = "learn plan.json run.csv --tip tool_mm --angle axis_mm"


@pytest.mark.usefixtures("files")
def test_the_first_line_says_what_was_left_and_the_next_plan_leaves_less(done, folder):
    out = done(f"{LINE} --output next.json --machine axis.json --output next.csv")
    first = " ".join(out.split("learned from")[0].split())
    number = r"([\d.]+)"
    words = re.fullmatch(
        rf"The move left {number} mm; the next move leaves at most {number} mm\. by frequency "
        rf"{number} mm: {number} Hz during the move, model 5 Hz repeatable {number} mm floor "
        rf"{number} mm, by friction and noise",
        first,
    )
    left, _, by_frequency, hertz, repeatable, floor = map(float, words.groups())
    # 5.4 Hz, as the axis was simulated
    assert hertz == pytest.approx(5.4, rel=2e-3)
    assert by_frequency == pytest.approx(left, rel=0.05)
    assert repeatable < 0.1 * left
    assert floor < 0.1
    assert "starts at 3.0000 s of the recording" in out
    assert "not used: column force_N" in out

    following = qa.Plan.load(folder / "next.json")
    actual = LinearAxis(omega1=2 * np.pi * 5.4, zeta1=0.01, mass=60.0, load=12.0, friction=40.0)
    task = qa.PointToPoint(actual, target=0.5, duration=0.7)
    moved = qa.evaluate_coefficients(task, following.coefficients, profile=following.profile)
    assert 1e3 * moved.residual < left / 50
    assert (folder / "next.csv").exists()
    machine = Identified.load(folder / "axis.json")
    assert machine.plant.omega1 / math.tau == pytest.approx(5.4, rel=1e-3)


@pytest.mark.slow
@pytest.mark.usefixtures("files")
def test_the_machine_is_a_plant_for_other_moves_and_keeps_what_it_knew(done, folder):
    done(f"{LINE} --machine axis.json")
    planned = done("plan axis.json --target 0.4 --duration 0.8 --terms 2")
    (rate,) = re.findall(r"omega1 = ([\d.]+) rad/s", planned)
    assert float(rate) == pytest.approx(2 * math.pi * 5.4, rel=1e-3)
    before = Identified.load(folder / "axis.json")
    done(f"{LINE} --machine axis.json")  # again, with what is there
    after = Identified.load(folder / "axis.json")
    assert after.plant == before.plant
    assert len(after.parts) == 2 * len(before.parts)


@pytest.mark.slow
@pytest.mark.usefixtures("files")
def test_axis_and_force_alone(done):
    out = done("learn plan.json run.csv --angle axis_mm --torque force_N")
    assert "5.4 Hz during the move, model 5 Hz" in " ".join(out.split())
    assert re.search(r"omega1 +5\.4\d* Hz during the moves", out)
    assert "what a torque does not tell" in " ".join(out.split())
    assert "not used: column tool_mm" in out


@pytest.mark.slow_after(5)
@pytest.mark.parametrize(
    ("line", "words"),
    [
        (f"{LINE} --output plan.json", "plan.json is given twice"),
        (f"{LINE} --machine plan.json", "plan.json is "),
        (f"{LINE} --machine run.csv", "run.csv is "),
        ("learn plan.json run.csv", "give the column of what rings: --tip, --acceleration or"),
        ("learn plan.json run.csv --torque force_N", "name the column of the joint by --angle"),
        ("learn run.csv run.csv --tip tool_mm", "run.csv is given twice"),
        ("learn plan.json plan.json --tip tool_mm", "plan.json is given twice"),
        (f"{LINE} --dearer 250", "--dearer"),
        (f"{LINE} --tip none", "none"),
        ("learn plan.json run.csv --tip axis_mm --angle tool_mm", "--tip and --angle exchanged?"),
        (f"{LINE} --units angle:cm", "its joint goes 5000 mm, and that of the plan 500"),
    ],
)
@pytest.mark.usefixtures("files")
def test_what_is_typed_wrongly_is_refused_in_a_line(refused, line, words):
    assert words in refused(line)


@pytest.mark.slow
@pytest.mark.usefixtures("files")
def test_the_file_of_another_machine_is_not_written_over(refused, folder):
    time = np.arange(0, 5, 0.005)
    beam = qa.FlexibleBeam(omega=20.0, zeta=0.01)
    tip = np.exp(-0.2 * time) * np.cos(20 * time)
    qa.identify([qa.Recording(time, tip=tip)], beam).save(folder / "beam.json")
    assert "is a machine of flexible-beam" in refused(f"{LINE} --machine beam.json")
    (folder / "other.json").write_text("{}")
    assert "other.json is not a machine" in refused(f"{LINE} --machine other.json")


@pytest.fixture
def dataset(folder):
    """A dataset of four moves, and recordings of two on an axis that swings at 5.4 Hz."""
    from quietarm.studies.sweep import MoveLibrary, sweep

    axes = {"target": [0.4, 0.5], "duration": [0.7, 0.8]}
    sweep(TASK, qa.CycloidPolynomial(3), axes=axes, path="moves.zarr")
    library = MoveLibrary("moves.zarr")
    actual = LinearAxis(omega1=2 * np.pi * 5.4, zeta1=0.01, mass=60.0, load=12.0, friction=40.0)
    for name, target, duration in (("a", 0.4, 0.7), ("b", 0.5, 0.8)):
        move = library.plan(target=target, duration=duration)
        task = qa.PointToPoint(actual, target=target, duration=duration)
        moved = qa.evaluate_coefficients(task, move.coefficients, profile=move.profile)
        time = np.arange(0, 1.8, 0.002)
        run = moved.sampled(time)
        axis = 1e3 * run.joint[:, 0]
        table = np.c_[time, axis + 1e3 * run.tips[:, 0], axis]
        header = "time_s,tool_mm,axis_mm"
        np.savetxt(f"{name}.csv", table, "%.6g", delimiter=",", header=header, comments="")
    return folder


MOVES = "--move target=400mm,duration=700ms --move target=0.5,duration=0.8"
COLUMNS = "--tip tool_mm --angle axis_mm"


@pytest.mark.slow
@pytest.mark.usefixtures("dataset")
def test_recordings_of_some_moves_correct_a_dataset(done, refused):
    out = " ".join(done(f"learn moves.zarr a.csv b.csv {MOVES} {COLUMNS} -o next.zarr").split())
    assert re.match(
        r"left [\d.]+ mm at most \(5\.4 Hz, model 5 Hz\); cells without a recording: \D*[\d.]+ mm, "
        r"at most \D*[\d.]+ mm \(each move left out once\)",
        out,
    )
    assert "wrote next.zarr: 4 moves" in out
    assert "to a state other than rest" in " ".join(
        done("plan --from next.zarr --target 0.4 --duration 0.8").split()
    )
    for line, words in (
        (f"a.csv {COLUMNS}", "1 recordings are given, and 0 times --move"),
        (f"a.csv --move target=0.4 {COLUMNS}", "give a value of each axis"),
        (f"a.csv --move target=0.5,duration=0.7 {COLUMNS}", "a.csv: it is of another move"),
        (f"a.csv {MOVES} {COLUMNS} --machine m.json", "--machine is for one plan"),
        (f"a.csv b.csv {MOVES} {COLUMNS} -o next.zarr", "next.zarr is there already"),
        (f"a.csv b.csv {MOVES} {COLUMNS} -o next.json", "give one dataset by --output"),
    ):
        assert words in refused(f"learn moves.zarr {line}")
