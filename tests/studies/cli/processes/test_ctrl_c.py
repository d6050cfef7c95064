"""Ctrl-C in a reproduction, which keeps the fronts that it has."""

import signal
import subprocess
import sys

from quietarm.ocp import Front
from quietarm.studies.reproduce.paper import ARM_HALF


def test_ctrl_c_ends_a_reproduction_and_keeps_its_fronts(folder):
    process = subprocess.Popen(
        [sys.executable, "-m", "quietarm", "reproduce", "--workers", "1", "--output", "results"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        while not process.stderr.readline().startswith("[1/"):
            assert process.poll() is None
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=120)  # one that does not end has hung
    finally:
        process.kill()
        process.communicate()  # closes its pipes
    assert (process.returncode, out) == (1, "")
    assert err.splitlines()[-1] == "quietarm: interrupted; what was written until then is kept"
    first = min((folder / "results" / "fronts").iterdir(), key=lambda path: path.stat().st_mtime)
    assert Front.load(first).task == ARM_HALF.task
