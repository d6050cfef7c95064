"""Searches that are broken off, killed and resumed."""

import os
import random
import shutil
import signal
import subprocess
import sys
import time

import pytest
from quietarm.metaheuristics import VEPSO, PaperNSGA2, PopulationObjective, search
from quietarm.metaheuristics.objective.population import CANDIDATE_STEPS
from quietarm.metaheuristics.runs import keeping
from quietarm.metaheuristics.runs.checkpoint import load_checkpoint
from small_searches import (
    HALF,
    IMPOSSIBLE,
    LIMITED,
    METHODS,
    exactly,
    found,
    one_line,
    run,
    stop_after,
)

# -- checkpoints --


@pytest.fixture
def always(monkeypatch):
    """A checkpoint after every generation."""
    monkeypatch.setattr(keeping, "CHECKPOINT_SECONDS", 0.0)


@pytest.fixture
def clock(monkeypatch):
    """A clock that stands still between the generations; `after` sets it forward after each."""
    now = [100.0]
    monkeypatch.setattr(time, "perf_counter", lambda: now[0])

    def after(seconds):
        def report(progress):
            now[0] += seconds

        return report

    return after


def test_a_checkpoint_is_written_every_two_seconds_and_at_the_end(tmp_path, monkeypatch, clock):
    written = []
    monkeypatch.setattr(
        keeping,
        "save_checkpoint",
        lambda path, header, state: written.append(len(state["hypervolume"])),
    )
    run("vepso", generations=8, checkpoint=tmp_path / "checkpoint", report=clock(0.75))
    # 0.75 s a generation: 2.25 s after three, and again after six; 1.5 s later it is over
    assert written == [3, 6, 8]


@METHODS
def test_a_checkpoint_changes_nothing(tmp_path, always, method):
    front = run(method, checkpoint=tmp_path / "checkpoint")
    assert exactly(front) == exactly(found(method))
    assert [entry.name for entry in tmp_path.iterdir()] == ["checkpoint"]


class CrashError(Exception):
    """What a test breaks a run off with, when it is not Ctrl-C."""


@METHODS
@pytest.mark.parametrize("limited", [False, True], ids=["free", "limits"])
@pytest.mark.parametrize("stop", [2, 9, 15])
def test_a_run_resumed_after_any_generation_ends_with_the_same_front(
    tmp_path, always, method, limited, stop
):
    task = LIMITED[method] if limited else None
    path = tmp_path / "checkpoint"
    part = run(method, task, checkpoint=path, report=stop_after(stop))
    assert not part.complete
    seen = []
    front = run(method, task, resume=path, report=seen.append)
    assert front.complete
    assert exactly(front) == exactly(found(method, task))
    assert [progress.generation for progress in seen] == list(range(stop + 1, 16))
    assert len(front.history) == 15


@METHODS
def test_ctrl_c_within_an_evaluation_leaves_a_checkpoint_to_go_on_from(
    tmp_path, monkeypatch, always, method
):
    calls, evaluate = [], PopulationObjective.__call__

    def interrupting(self, coefficients):
        if self.steps == CANDIDATE_STEPS:
            calls.append(1)
            if len(calls) == 5:
                signal.raise_signal(signal.SIGINT)
        return evaluate(self, coefficients)

    path = tmp_path / "checkpoint"
    monkeypatch.setattr(PopulationObjective, "__call__", interrupting)
    part = run(method, checkpoint=path)
    assert not part.complete
    assert len(part.history) == 5  # the generation that it came in is whole
    assert part.evaluations == part.history[-1].evaluations
    assert part.history == found(method).history[: len(part.history)]
    assert exactly(run(method, resume=path)) == exactly(found(method))


@METHODS
@pytest.mark.parametrize("where", ["evaluation", "report"])
def test_an_error_leaves_a_checkpoint_to_go_on_from(tmp_path, monkeypatch, always, method, where):
    calls, evaluate = [], PopulationObjective.__call__

    def crash(*arguments):
        calls.append(1)
        if len(calls) == 5:
            raise CrashError
        return evaluate(*arguments) if where == "evaluation" else None

    path, seen = tmp_path / "checkpoint", []
    options = {"report": crash} if where == "report" else {}
    with monkeypatch.context() as patch:
        if where == "evaluation":
            patch.setattr(PopulationObjective, "__call__", crash)
        with pytest.raises(CrashError):
            run(method, checkpoint=path, **options)
    front = run(method, resume=path, report=seen.append)
    assert seen[0].generation == 5
    assert exactly(front) == exactly(found(method))


@METHODS
def test_limits_that_nothing_keeps_yet_can_be_saved_and_resumed(tmp_path, always, method):
    task = IMPOSSIBLE[method]
    path = tmp_path / "checkpoint"
    run(method, task, generations=6, checkpoint=path, report=stop_after(4))
    front = run(method, task, generations=6, resume=path)
    assert exactly(front) == exactly(run(method, task, generations=6))


@METHODS
def test_a_run_may_be_broken_off_and_resumed_again_and_again(tmp_path, always, method):
    path = tmp_path / "checkpoint"
    run(method, checkpoint=path, report=stop_after(4))
    run(method, checkpoint=path, resume=path, report=stop_after(8))
    run(method, checkpoint=path, resume=path, report=stop_after(12))
    front = run(method, checkpoint=path, resume=path)
    assert exactly(front) == exactly(found(method))


@METHODS
def test_time_adds_up_over_runs(tmp_path, always, clock, method):
    path, tick = tmp_path / "checkpoint", clock(2.0)

    def stop(progress):
        tick(progress)
        stop_after(3)(progress)

    part = run(method, checkpoint=path, report=stop)
    assert part.seconds == 6.0
    seen = []

    def report(progress):
        seen.append(progress.seconds)
        tick(progress)

    front = run(method, resume=path, report=report)
    assert seen == [6.0 + 2.0 * k for k in range(12)]
    assert front.seconds == 6.0 + 12 * 2.0


@METHODS
def test_resuming_a_run_that_was_over_gives_its_front(tmp_path, method):
    path = tmp_path / "checkpoint"
    run(method, checkpoint=path)
    seen = []
    assert exactly(run(method, resume=path, report=seen.append)) == exactly(found(method))
    assert seen == []


@METHODS
def test_threads_may_differ_when_a_run_is_resumed(tmp_path, always, method):
    path = tmp_path / "checkpoint"
    settings = {"population": 210, "generations": 4}
    run(method, **settings, checkpoint=path, report=stop_after(3))
    assert exactly(run(method, **settings, resume=path, threads=2)) == exactly(
        run(method, **settings)
    )


@pytest.mark.parametrize("make", [lambda: VEPSO(particles=8), lambda: PaperNSGA2(8)])
def test_the_two_given_as_objects_can_be_resumed(tmp_path, always, make):
    path = tmp_path / "checkpoint"
    settings = {"bound": 0.5, "generations": 8, "seed": 4}
    whole = search(HALF, make(), **settings)
    search(HALF, make(), **settings, checkpoint=path, report=stop_after(5))
    assert exactly(search(HALF, make(), **settings, resume=path)) == exactly(whole)


@METHODS
@pytest.mark.parametrize("comes_back", [False, True])
def test_a_checkpoint_that_can_no_longer_be_written_stops_no_search(
    tmp_path, always, method, comes_back
):
    path, warnings = tmp_path / "folder" / "checkpoint", []
    path.parent.mkdir()

    def remove(progress):
        if progress.generation == 4:
            shutil.rmtree(path.parent)
        if progress.generation == 8 and comes_back:
            path.parent.mkdir()

    front = run(method, checkpoint=path, report=remove, warn=warnings.append)
    assert exactly(front) == exactly(found(method))
    if comes_back:
        assert warnings == []
        assert exactly(run(method, resume=path)) == exactly(front)
    else:
        (line,) = warnings
        assert line.startswith("the end of the search is in no checkpoint: ")
        assert line.endswith(f"folder {path.parent} does not exist; make it first")


def test_a_lost_checkpoint_is_a_warning_of_pythons(tmp_path, always, monkeypatch):
    def full(path, content):
        raise ValueError(f"{path} cannot be written: no space left on device")

    monkeypatch.setattr("quietarm.metaheuristics.runs.checkpoint.write_whole", full)
    with pytest.warns(RuntimeWarning, match="no space left on device"):
        front = run("vepso", checkpoint=tmp_path / "checkpoint")
    assert front.complete


def test_a_checkpoint_that_cannot_be_written_is_found_before_the_work(tmp_path):
    seen = []
    for path in (tmp_path / "missing" / "checkpoint", tmp_path):
        with pytest.raises(ValueError, match="folder") as caught:
            run("nsga2", checkpoint=path, report=seen.append)
        one_line(caught)
    assert seen == []


# -- SIGKILL --

KILLED = """
import math, os, signal, sys, threading
from quietarm.metaheuristics import search
from quietarm.metaheuristics.runs import keeping
from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.ocp import PointToPoint

method, path, generation, delay = sys.argv[1:]
keeping.CHECKPOINT_SECONDS = 0.0
end = threading.Timer(float(delay), os.kill, (os.getpid(), signal.SIGKILL))
task, bound = {
    "nsga2": (PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8), 0.5),
    "vepso": (PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8), 0.2),
}[method]

def report(progress):
    print(progress.generation, flush=True)
    if progress.generation == int(generation):
        end.start()

search(
    task, method, bound=bound, population=20, generations=50, seed=5, checkpoint=path, report=report
)
end.join()  # should it be over before it is killed
"""


@METHODS
@pytest.mark.skipif(os.name == "nt", reason="there is no SIGKILL")
def test_a_run_that_was_killed_ends_bit_for_bit_as_one_that_was_not(tmp_path, method):
    path, moment = tmp_path / "checkpoint", random.Random(method)
    generation, delay = moment.randint(2, 25), moment.uniform(0, 0.02)
    command = [sys.executable, "-c", KILLED, method, path, str(generation), str(delay)]
    killed = subprocess.run(command, stdout=subprocess.PIPE, text=True, timeout=600, check=False)
    assert killed.returncode == -signal.SIGKILL
    told = [int(line) for line in killed.stdout.split()]
    assert told == list(range(1, len(told) + 1))
    assert len(told) >= generation
    # the checkpoint comes after the report of its generation, and is whole whenever it came
    saved = len(load_checkpoint(path)[1]["hypervolume"])
    assert saved in (len(told) - 1, len(told))
    seen = []
    front = run(method, seed=5, generations=50, resume=path, report=seen.append)
    assert [progress.generation for progress in seen] == list(range(saved + 1, 51))
    assert front.complete
    assert exactly(front) == exactly(found(method, seed=5, generations=50))
