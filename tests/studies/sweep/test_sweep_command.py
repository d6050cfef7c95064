"""`quietarm sweep`: certified plans of a grid, whatever stops it on the way."""

import math
import os
import signal
import subprocess
import time

import numpy as np
import pytest
import xarray as xr
from lines import QUIETARM

import quietarm as qa
from quietarm.models import FlexibleBeam, SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, PointToPoint, plan_move

MOVES = "sweep single-link --target 10deg:40deg:10deg --duration 600ms:1.4s:10ms --terms 3 --quiet"
FEW = "sweep single-link --target 30deg,60deg --duration 0.8,1.2 --quiet --output few.zarr"


def dataset(path):
    return xr.open_zarr(path, consolidated=False).load()


def same(one, other):
    return all(np.array_equal(one[name], other[name], equal_nan=True) for name in one.data_vars)


def started(line):
    return subprocess.Popen([QUIETARM, *line.split()], stdout=subprocess.DEVNULL)


def test_one_axis_is_shown_as_a_table_and_too_short_a_move_says_so(done, folder):
    out = done(
        "sweep single-link --target 30deg --duration 400ms:1.2s:400ms --acceleration-limit 40 "
        "--terms 6 --quiet --output times.zarr --output times.png"
    )
    assert (folder / "times.png").read_bytes().startswith(b"\x89PNG")
    lines = [line.split() for line in out.splitlines()]
    none, short, long = [line for line in lines if line and line[0] in ("0.4", "0.8", "1.2")]
    assert none[1:3] == ["-", "-"]
    assert short[2] == long[2] == "rest"
    task = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8, acceleration_limit=40)
    plan = plan_move(task, CycloidPolynomial(6))
    assert float(short[1]) == pytest.approx(plan.energy, rel=1e-3)  # limits: docs/accuracy.md
    assert float(long[1]) < float(short[1])


@pytest.mark.slow
def test_every_cell_is_the_plan_of_its_move_by_command_and_in_python(call, done, folder):
    out = done(FEW + " --output few.png")
    assert "4 of 4 moves have a plan" in out
    found = dataset("few.zarr")
    assert found.energy.dims == ("target", "duration")
    assert found.energy.attrs["units"] == "J"
    plan = plan_move(PointToPoint(SingleLinkManipulator(), math.pi / 3, 1.2))
    cell = found.isel(target=1, duration=1)
    # by gradient from several starts and here from the cells beside: docs/sweeps.md
    assert float(cell.energy) == pytest.approx(plan.energy, rel=1e-4)
    assert float(cell.residual) < 1e-7
    assert float(cell.peak_speed) == pytest.approx(plan.motion.peak_speed, rel=0.01)
    assert float(cell.price_residual) > 0
    (frequency,) = [one for one in plan.sensitivities if one.parameter == "frequency"]
    # by fixed steps and by CVODES
    assert float(cell.residual_by_frequency) == pytest.approx(frequency.residual, rel=1e-3)
    assert float(cell.energy_by_frequency) == pytest.approx(frequency.energy, rel=1e-3)
    assert np.isfinite(found.cold_excess).sum() == 1
    assert np.nanmax(found.cold_excess) < 1e-4  # docs/sweeps.md
    assert (folder / "few.png").read_bytes().startswith(b"\x89PNG")
    code, out, err = call(FEW.replace("30deg,60deg", "30deg,70deg"))
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "is of another sweep: it differs in target" in err
    task = qa.PointToPoint(qa.SingleLinkManipulator(), target=math.radians(60), duration=1.0)
    axes = {"target": [math.radians(60), math.radians(30)], "duration": [0.8, 1.2]}
    made = qa.sweep(task, axes=axes, path=folder / "made.zarr").load()
    # the digest is of the task as well, whose duration is another than the command's
    assert same(made.drop_vars("digest"), found.drop_vars("digest"))
    with pytest.raises(ValueError, match="did you mean 'omega'"):
        qa.sweep(task, axes={"omga": [9.0, 10.0]}, path=folder / "other.zarr")


@pytest.mark.slow
def test_parameters_are_axes_and_what_cannot_be_has_a_reason(done, folder):
    out = done(
        "sweep flexible-beam --set tip_mass=0,200g --target 60deg --duration 0.5,1 --quiet "
        "--torque-limit 0.6 --terms 6 --output payload.zarr --output payload.png"
    )
    assert "infeasible 1 move" in " ".join(out.split())
    found = dataset("payload.zarr")
    meanings = found.status.attrs["flag_meanings"].split()
    assert meanings[int(found.status.sel(tip_mass=0.2, duration=0.5))] == "infeasible"
    assert np.isfinite(found.energy).sum() == 3
    task = PointToPoint(FlexibleBeam(tip_mass=0.0), math.pi / 3, 0.5, torque_limit=0.6)
    light = plan_move(task, CycloidPolynomial(6))
    here = float(found.energy.sel(tip_mass=0.0, duration=0.5))
    assert here == pytest.approx(light.energy, rel=1e-3)  # limits: docs/accuracy.md


@pytest.mark.slow
def test_two_parts_and_a_killed_run_end_as_one_that_ran_through(call, folder):
    assert call(f"{MOVES} --output whole.zarr")[0] == 0
    whole = dataset("whole.zarr")
    assert whole.energy.size == 4 * 81  # two chunks
    other = started(f"{MOVES} --output parts.zarr --part 1/2")
    assert call(f"{MOVES} --output parts.zarr --part 2/2")[0] == 0
    assert other.wait(timeout=300) == 0
    assert same(dataset("parts.zarr"), whole)

    killed = started(f"{MOVES} --output killed.zarr")
    status = folder / "killed.zarr" / "status" / "c"
    for _ in range(3000):  # until the first chunk is there
        if status.exists() or killed.poll() is not None:
            break
        time.sleep(0.05)
    os.kill(killed.pid, signal.SIGKILL)
    killed.wait(timeout=60)
    assert call(f"{MOVES} --output killed.zarr")[0] == 0
    assert same(dataset("killed.zarr"), whole)


@pytest.mark.slow
def test_workers_here_and_of_a_cluster_make_the_same_dataset(call, folder):
    axes = "--target 30deg,60deg --duration 800ms:1.2s:80ms"
    line = f"sweep single-link {axes} --terms 3 --error frequency=1% --quiet"  # two chunks
    assert call(f"{line} --workers 1 --output one.zarr")[0] == 0
    one = dataset("one.zarr")
    assert call(f"{line} --workers 2 --output two.zarr")[0] == 0
    assert same(dataset("two.zarr"), one)
