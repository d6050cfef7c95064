"""Work side by side: who does it, and what becomes of the workers and of the work."""

import os
import signal
import socket
import subprocess
import sys
import time
from functools import partial

import psutil
import pytest

from quietarm.metaheuristics import parallel
from quietarm.metaheuristics.parallel import LostWorkersError, side_by_side
from quietarm.studies.cli.application import main

GUARD = 120
"""Seconds after which what does not come has hung, on any machine."""
PARENT = """
import time
from quietarm.metaheuristics.parallel import side_by_side
for number in side_by_side(time.sleep, [0, 0, 0, 0, 1000, 1000], workers=2):
    print("ended", flush=True)
"""


def wait_until(holds):
    end = time.monotonic() + GUARD
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.05)


@pytest.mark.slow
def test_workers_end_with_a_parent_that_is_killed():
    parent = subprocess.Popen([sys.executable, "-c", PARENT], stdout=subprocess.PIPE, text=True)
    assert parent.stdout.readline() == "ended\n"
    workers = psutil.Process(parent.pid).children(recursive=True)
    assert len(workers) >= 2
    parent.kill()
    parent.communicate()
    _, alive = psutil.wait_procs(workers, timeout=GUARD)
    assert alive == []


def process_and_square(number, seconds=0.0):
    time.sleep(seconds)
    return os.getpid(), number**2


class Cluster:
    """A scheduler of dask and its worker of one thread, without what would start it again."""

    def __init__(self, folder):
        self._processes = [self._start("scheduler", "--port=0", "--no-dashboard",
                                       f"--scheduler-file={folder}/scheduler.json")]  # fmt: skip
        file = folder / "scheduler.json"
        wait_until(lambda: file.exists() and file.read_text().endswith("}"))
        self.address = file.read_text().partition('"address": "')[2].partition('"')[0]
        self.worker = self._start("worker", self.address, "--nthreads=1", "--no-nanny",
                                  "--no-dashboard", f"--local-directory={folder}")  # fmt: skip
        self._processes.append(self.worker)
        wait_until(lambda: parallel._threads_of(self.address) == 1)

    @staticmethod
    def _start(*words):
        line = [sys.executable, "-m", "distributed.cli.dask_" + words[0], *words[1:]]
        return subprocess.Popen(line, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def end(self):
        for process in reversed(self._processes):
            process.kill()
            process.wait()


@pytest.fixture
def cluster(tmp_path):
    cluster = Cluster(tmp_path)
    yield cluster
    cluster.end()


@pytest.mark.slow
def test_a_cluster_of_one_thread_does_the_work_and_is_not_waited_for_when_it_is_dead(
    cluster, monkeypatch
):
    answers = [*side_by_side(process_and_square_elsewhere(), [1, 2, 3], workers=cluster.address)]
    assert {process for process, _ in answers} == {cluster.worker.pid}
    assert sorted(square for _, square in answers) == [1, 4, 9]
    monkeypatch.setattr(parallel, "_ANSWER_SECONDS", 2)
    monkeypatch.setattr(parallel, "_LOOK_SECONDS", 0.2)
    slow = process_and_square_elsewhere(seconds=1000)
    work = side_by_side(lambda number: slow(number) if number else None, [0, 1], cluster.address)
    assert next(work) is None
    cluster.worker.send_signal(signal.SIGKILL)
    with pytest.raises(LostWorkersError, match=r"all workers of the scheduler at .* are gone"):
        next(work)
    with pytest.raises(ValueError, match=r"has no workers; start some with `dask worker"):
        next(side_by_side(abs, [1, 2], workers=cluster.address))


def process_and_square_elsewhere(seconds=0.0):
    """A function that a process without this file has, too."""
    from cloudpickle import register_pickle_by_value

    register_pickle_by_value(sys.modules[__name__])
    return partial(process_and_square, seconds=seconds)


@pytest.mark.slow
def test_a_scheduler_that_is_none_is_told_in_a_line(monkeypatch):
    monkeypatch.setattr(parallel, "_ANSWER_SECONDS", 1)
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))
        silent.listen()
        port = silent.getsockname()[1]
        for address, reason in {
            f"tcp://127.0.0.1:{port}": r"not within 1 s",
            f"tls://127.0.0.1:{port}": r"TLS expects",
            f"foo://127.0.0.1:{port}": r"unknown address scheme",
            "inproc://here": "host and port",
            "here:1": "Invalid url scheme",
        }.items():
            with pytest.raises(ValueError, match=rf"^no scheduler answers at .*{reason}") as told:
                next(side_by_side(abs, [1, 2], workers=address))
            assert "\n" not in str(told.value)


@pytest.mark.parametrize("line", [
    "sweep single-link --target 0.1:0.3:0.1 --duration 1 --output new.zarr",
    "bench single-link-30deg-0.8s --runs 1 --evaluations 200 --output new",
])  # fmt: skip
def test_nothing_is_written_where_no_scheduler_answers(tmp_path, monkeypatch, capsys, line):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        main([*line.split(), "--scheduler", "foo://127.0.0.1:1"])
    assert ended.value.code == 2
    assert "quietarm: no scheduler answers at foo://127.0.0.1:1" in capsys.readouterr().err
    assert not [*tmp_path.iterdir()]
