"""A whole dataset corrected by recordings of some of its moves, on a machine with another model."""

from dataclasses import replace

import numpy as np
import pytest

import quietarm as qa
from quietarm.machine.learn.learn_moves import SmoothDeviation
from quietarm.models import LinearAxis
from quietarm.studies.sweep import MoveLibrary, learn_set, plan_from, sweep
from quietarm.studies.sweep.learned_rows import set_sentence

AXIS = LinearAxis(omega1=2 * np.pi * 5, zeta1=0.01, mass=60.0, load=12.0, friction=40.0)
TASK = qa.PointToPoint(AXIS, target=0.5, duration=0.8)
AXES = {"target": [0.4, 0.5, 0.6], "duration": [0.7, 0.8, 0.9]}
RECORDED = [(0.4, 0.7), (0.6, 0.7), (0.4, 0.9), (0.6, 0.9)]


def on_machine(plan):
    """The plan's motion on a machine that swings at 5.4 Hz."""
    task = replace(plan.task, plant=replace(AXIS, omega1=2 * np.pi * 5.4), final=None)
    return qa.evaluate_coefficients(task, plan.coefficients, profile=plan.profile)


def kick(plan):
    """Return what each move leaves besides, by a fault that grows with its acceleration [m]."""
    return 3e-4 * plan.task.target / plan.task.duration**2


def recording(plan, seed):
    """A laser's and an encoder's; the fault is a swing that begins on arrival."""
    time = np.arange(0, plan.task.duration + 1.2, 0.002)
    run = on_machine(plan).sampled(time)
    since = np.maximum(time - plan.task.duration, 0.0)
    omega = 2 * np.pi * 5.4
    rings = kick(plan) * np.exp(-0.01 * omega * since) * np.sin(omega * since)
    place = run.joint[:, 0]
    noise = np.random.default_rng(seed).normal(0, 1e-5, len(time))
    tip = place + run.tips[:, 0] + rings + noise
    return qa.Recording(time, tip=tip, angle=place, name=f"run{seed}")


def left_by(plan):
    """Amplitude at arrival of what the machine leaves [m]."""
    omega = 2 * np.pi * 5.4
    W, rate = on_machine(plan).candidate.arrival[0]
    return float(np.hypot(W, rate / omega + kick(plan)))


def test_a_deviation_is_what_is_left_of_the_set_points_that_make_up_for_it():
    smooth = SmoothDeviation((0.5, 0.5, 0.8), (0.1, 0.1, 0.1), (1.2, 0.1), ((1e-4, -2e-4),) * 10)
    move = (0.0, 0.55, 0.75)
    told = smooth.told_for(move, 1e-5 + 0j)
    assert complex(1.2, 0.1) * told + smooth.deviation(move) == pytest.approx(1e-5, abs=1e-15)
    assert smooth.deviation((0.0, 0.55, 0.75)) != 0


@pytest.mark.slow
def test_recordings_of_four_cells_correct_all_nine(tmp_path):
    sweep(TASK, qa.CycloidPolynomial(4), axes=AXES, path=tmp_path / "moves.zarr")
    library = MoveLibrary(tmp_path / "moves.zarr")
    runs = [
        ({"target": target, "duration": duration}, recording(
            library.plan(target=target, duration=duration), seed
        ))
        for seed, (target, duration) in enumerate(RECORDED)
    ]  # fmt: skip

    learned = learn_set(library, runs)
    definition = learned.definition
    allowing = replace(definition.settings, residual_limit=1e-3)
    of_limit = replace(learned, definition=replace(definition, settings=allowing))
    assert set_sentence(of_limit, AXIS) == (
        f"{set_sentence(learned, AXIS)}, beside the 1 mm that each plan itself may leave"
    )

    _, new = learned.changed["omega1"]
    assert new == pytest.approx(2 * np.pi * 5.4, rel=1e-3)  # as the machine was simulated
    assert len(learned.left_out) == 4
    corrected = learned.write(tmp_path / "learned.zarr")
    before, after = (
        {
            (target, duration): left_by(each.plan(target=target, duration=duration))
            for target in AXES["target"]
            for duration in AXES["duration"]
        }
        for each in (library, corrected)
    )
    others = [cell for cell in before if cell not in RECORDED]
    assert max(after.values()) < max(before.values()) / 30
    assert max(after[cell] for cell in others) < 2 * max(learned.left_out)
    # the fault alone, which the frequency does not explain, is made up for as well
    assert max(after[cell] for cell in others) < 0.8 * 3e-4 * 0.6 / 0.7**2
    # the dataset of a learned sweep is one as any other, and knows what it was learned from
    again = MoveLibrary(tmp_path / "learned.zarr")
    assert again.grid.arrivals.history.moves == learned.moves
    plan, _, broken = plan_from(again, target=0.5, duration=0.8)
    assert broken is None
    assert plan.task.final is not None
    following = learn_set(again, [({"target": 0.5, "duration": 0.8}, recording(plan, 9))])
    assert len(following.moves) == 5


@pytest.mark.slow
def test_what_is_no_set_of_moves_of_one_machine_is_refused(tmp_path):
    axes = {"omega1": [30.0, 32.0], "duration": [0.8, 0.9]}
    sweep(TASK, qa.CycloidPolynomial(3), axes=axes, path=tmp_path / "plants.zarr")
    with pytest.raises(ValueError, match="has an axis over omega1, and recordings are of one"):
        learn_set(tmp_path / "plants.zarr", [])
