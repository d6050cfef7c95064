"""How IPOPT is loaded."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

THREADS = """
import os
before = dict(os.environ)
from math import pi
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import PointToPoint, plan_move
import numpy, casadi
def threads():
    return len(os.listdir("/proc/self/task"))
loaded = threads()
plan_move(PointToPoint(SingleLinkManipulator(), pi / 6, 0.8), starts=1, solver="ipopt")
assert dict(os.environ) == before, "the environment changed"
print(threads() - loaded)
"""


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="threads are counted on Linux")
def test_ipopt_takes_one_thread():
    ours = {name: value for name, value in os.environ.items() if "NUM_THREADS" not in name}
    command = [sys.executable, "-c", THREADS]
    done = subprocess.run(command, env=ours, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert int(done.stdout) == 0
