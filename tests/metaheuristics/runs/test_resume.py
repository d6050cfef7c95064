"""Searches that are broken off, killed and resumed."""

import os
import signal
import subprocess
import sys

import pytest
from quietarm.metaheuristics import PRESETS
from quietarm.ocp import FileFormatError
from small_searches import HALF, LIMITED, METHODS, SIXTH, exactly, found, run


def broken_off(after, error=KeyboardInterrupt):
    def report(progress):
        if progress.generation == after:
            raise error

    return report


@pytest.fixture(scope="module")
def checkpoints(tmp_path_factory):
    """A checkpoint of five generations of each method."""
    folder = tmp_path_factory.mktemp("checkpoints")
    for method in ("nsga2", "vepso"):
        run(method, checkpoint=folder / method, report=broken_off(5))
    return folder


@METHODS
@pytest.mark.parametrize("limited", [False, True], ids=["free", "limits"])
@pytest.mark.parametrize(
    "stop",
    [1, 9],
)
def test_a_run_resumed_after_any_generation_ends_with_the_same_front(
    tmp_path, method, limited, stop
):
    task, kept = LIMITED[method] if limited else None, tmp_path / "checkpoint"
    part = run(method, task, checkpoint=kept, report=broken_off(stop))
    assert not part.complete
    assert len(part.history) == stop
    resumed = run(method, task, resume=kept)
    assert exactly(resumed) == exactly(found(method, task))


@pytest.mark.parametrize("method", [name for name, one in PRESETS.items() if not one.needs])
def test_every_method_goes_on(tmp_path, method):
    settings = {"bound": 0.2, "population": 12, "generations": 6}
    kept = tmp_path / "checkpoint"
    search = {"task": SIXTH, "method": method, **settings}
    whole = found_by(**search)
    found_by(**search, checkpoint=kept, report=broken_off(3))
    assert exactly(found_by(**search, resume=kept)) == exactly(whole)


def found_by(task, method, **settings):
    from quietarm.metaheuristics import search

    return search(task, method, **settings)


@METHODS
def test_a_run_may_be_broken_off_and_resumed_in_the_same_file(tmp_path, method):
    kept = tmp_path / "checkpoint"
    run(method, checkpoint=kept, report=broken_off(3))
    run(method, checkpoint=kept, resume=kept, report=broken_off(2))  # while it repeats
    run(method, checkpoint=kept, resume=kept, report=broken_off(8))
    assert exactly(run(method, resume=kept)) == exactly(found(method))


def test_a_full_disk_stops_no_search(tmp_path, monkeypatch):
    def full(path, content):
        raise ValueError("no space left on device")

    monkeypatch.setattr("quietarm.metaheuristics.runs.checkpoint.write_whole", full)
    with pytest.warns(RuntimeWarning, match="no space left on device"):
        front = run("nsga2", checkpoint=tmp_path / "checkpoint")
    assert exactly(front) == exactly(found("nsga2"))


# -- refusals --


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"task": HALF.__class__(HALF.plant, HALF.target, 0.9)}, "duration is 0.8, not 0.9"),
        ({"seed": 1}, "seed is 0, not 1"),
        ({"settings": {"crossover": 0.7}}, "crossover"),
    ],
)
def test_a_checkpoint_of_another_search_is_refused(checkpoints, changes, words):
    with pytest.raises(ValueError, match="is of another search") as told:
        run("nsga2", **changes, resume=checkpoints / "nsga2")
    assert words in str(told.value)


def test_a_checkpoint_of_another_version_is_refused(checkpoints, monkeypatch):
    monkeypatch.setattr("quietarm.metaheuristics.runs.settings.versions", lambda: {"casadi": "1"})
    with pytest.raises(ValueError, match="other software: its version of"):
        run("nsga2", resume=checkpoints / "nsga2")


@pytest.mark.parametrize(
    "spoil",
    [lambda b: b[: len(b) // 2], lambda b: b"a,b\n1,2\n"],
)
def test_what_is_no_checkpoint_is_refused(checkpoints, tmp_path, spoil):
    (tmp_path / "c").write_bytes(spoil((checkpoints / "nsga2").read_bytes()))
    with pytest.raises(FileFormatError, match="not a checkpoint, or not a whole one"):
        run("nsga2", resume=tmp_path / "c")


def test_figures_that_were_changed_are_refused(checkpoints, tmp_path):
    import numpy as np

    with np.load(checkpoints / "nsga2") as archive:
        arrays = dict(archive)
    arrays["figures"][0, 1] /= 2
    with (tmp_path / "c").open("wb") as file:
        np.savez(file, **arrays)
    with pytest.raises(ValueError, match="does not come to what is in its checkpoint"):
        run("nsga2", resume=tmp_path / "c")


# -- a process that is killed --

LONG = """
import sys
from quietarm.metaheuristics import search
from quietarm.metaheuristics.runs import checkpoint
from small_searches import SIXTH
checkpoint.CHECKPOINT_SECONDS = 0.0
def report(progress):
    print(progress.generation, flush=True)
    if {slow}:
        import time; time.sleep(0.1)
search(SIXTH, "vepso", bound=0.2, population=20, generations=15, checkpoint=sys.argv[1],
       report=report)
"""


def test_a_run_that_was_killed_ends_bit_for_bit_as_one_that_was_not(tmp_path):
    kept = tmp_path / "checkpoint"
    code = LONG.format(slow=True)
    paths = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    with subprocess.Popen(
        [sys.executable, "-c", code, str(kept)], stdout=subprocess.PIPE, text=True, env=paths
    ) as process:
        for line in process.stdout:
            if int(line) >= 6:
                process.send_signal(signal.SIGKILL)
    assert exactly(run("vepso", resume=kept)) == exactly(found("vepso"))
