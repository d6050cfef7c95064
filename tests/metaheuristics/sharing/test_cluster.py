"""Pieces shared by real workers: those of a scheduler started by its own command, and local ones.

In order: the scheduler has no workers at first, and is ended by the last test that needs it.
"""

import contextlib
import math
import multiprocessing
import os
import signal
import socket
import subprocess
import sys
from functools import partial

import pytest
import small_pieces
from quietarm.metaheuristics import search, search_many
from quietarm.metaheuristics.ensemble import LostSeedsError, one_seed
from quietarm.metaheuristics.sharing.pieces import Listener, LostPieceError, Piece
from quietarm.metaheuristics.sharing.running import run_pieces
from quietarm.metaheuristics.sharing.workers import Workers
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import PointToPoint

TASK = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8)
SMALL = {"bound": 0.2, "population": 8, "generations": 3}
LONG = {**SMALL, "population": 40, "generations": 100_000}  # it never ends by itself
SIGKILL = pytest.mark.skipif(sys.platform == "win32", reason="needs SIGKILL")


@contextlib.contextmanager
def dask(*words, until):
    """A command of dask's own, from the line on standard error that holds these words."""
    process = subprocess.Popen(
        [sys.executable, "-m", "dask", *words],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    try:
        line = next(line for line in process.stderr if until in line)
        yield process, line.split()[-1]
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


@pytest.fixture(scope="module")
def scheduler():
    """A scheduler: its process and its address."""
    words = "scheduler --host 127.0.0.1 --port 0 --no-dashboard"
    with dask(*words.split(), until="Scheduler at:") as started:
        yield started


@pytest.fixture(scope="module")
def address(scheduler, tmp_path_factory):
    """The address of a scheduler that has two workers."""
    _, address = scheduler
    words = f"worker {address} --nworkers 2 --nthreads 1 --no-dashboard --local-directory"
    folder = tmp_path_factory.mktemp("workers")
    with dask(*words.split(), str(folder), until="Registered to:") as (process, _):
        next(line for line in process.stderr if "Registered to:" in line)  # the second one
        yield address


def test_its_workers_find_the_fronts_of_single_searches(address):
    done, heard = [], set()
    fronts = search_many(
        TASK, "vepso", 3, scheduler=address, **SMALL, done=done.append,
        report=lambda progress, seed: heard.add(seed),
    )  # fmt: skip
    assert fronts == [search(TASK, "vepso", seed=seed, **SMALL) for seed in (0, 1, 2)]
    assert sorted(front.seed for front in done) == [0, 1, 2]
    assert heard == {0, 1, 2}


def test_after_ctrl_c_what_was_found_is_there_and_the_workers_are_free(address):
    heard = set()

    def interrupt(progress, seed):
        if seed not in heard:
            heard.add(seed)
            if heard == {0, 1}:
                signal.raise_signal(signal.SIGINT)

    fronts = search_many(TASK, "nsga2", 4, scheduler=address, report=interrupt, **LONG)
    assert [(front.seed, front.complete) for front in fronts] == [(0, False), (1, False)]
    assert all(front.points for front in fronts)
    # else these would wait for ever: a worker does one piece at a time
    pieces = [Piece(i, str(i), small_pieces.add) for i in range(4)]
    assert run_pieces(pieces, workers=Workers(scheduler=address)).number == 4


def test_a_scheduler_that_goes_leaves_what_was_found(address, scheduler):
    process, _ = scheduler
    ended = []

    def note_end(key, answer):
        ended.append(key)

    def end_scheduler(key, progress):
        if ended and process.poll() is None:
            process.kill()
            process.wait()

    pieces = [
        Piece("short", "short", small_pieces.add),
        Piece("long", "long", partial(one_seed, TASK, "nsga2", LONG, 0)),
    ]
    listener = Listener(report=end_scheduler, ended=note_end)
    done = run_pieces(pieces, listener, workers=Workers(scheduler=address))
    assert done.stopped == f"the scheduler at {address} is gone"
    assert done.answers == {"short": 1}
    assert not done.parts["long"].complete
    assert done.parts["long"].points
    error = LostSeedsError(done, list(done.parts.values()), 2)
    assert str(error) == f"{done.stopped}; 1 of 2 seeds are done; 1 in part"


@SIGKILL
def test_a_piece_that_kills_its_worker_three_times_is_reported(tmp_path):
    deaths = tmp_path / "deaths"
    killing = partial(small_pieces.kill_always, str(deaths))
    pieces = [Piece("killing", "killing", killing), Piece("other", "other", small_pieces.parent)]
    done = run_pieces(pieces, workers=Workers(2), note=LostPieceError)
    # workers are forked from a process that loads for all of them what they need
    assert done.answers.keys() == {"other"}
    assert done.answers["other"] != os.getpid()
    assert str(done.failures["killing"]) == "its worker died 3 times"
    assert deaths.read_text() == "xxx"
    assert multiprocessing.active_children() == []


def test_a_script_whose_workers_would_run_it_again_is_told_so(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "import quietarm as qa\n"
        "task = qa.PointToPoint(qa.SingleLinkManipulator(), 0.5, 0.8)\n"
        "qa.search_many(task, 'vepso', 2, workers=2, bound=0.2, population=8, generations=3)\n"
    )
    ran = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=240)
    assert ran.returncode == 1
    assert "run it under if __name__ == '__main__', or with one" in ran.stderr.splitlines()[-1]


def test_what_is_no_scheduler_is_told_from_one_that_says_nothing(monkeypatch):
    work = [Piece("a", "a", small_pieces.add)]
    with pytest.raises(ValueError, match="scheduler is 'here'; give it as tcp://host:8786"):
        run_pieces(work, workers=Workers(scheduler="here"))
    from quietarm.metaheuristics.sharing import scheduler

    monkeypatch.setattr(scheduler, "_CONNECT_SECONDS", 1)
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))
        silent.listen()
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        with pytest.raises(ValueError, match=f"no scheduler answers at {address}"):
            run_pieces(work, workers=Workers(scheduler=address))


@pytest.mark.parametrize("name", ["checkpoint", "resume"])
def test_a_checkpoint_is_not_for_the_workers_of_a_scheduler(tmp_path, name):
    with pytest.raises(ValueError, match="a checkpoint is a file of this machine"):
        search_many(TASK, "vepso", 1, scheduler="tcp://a:1", **SMALL, **{name: tmp_path / "state"})
