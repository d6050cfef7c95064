"""Lines that several tests of the command line use, and the installed command."""

import shlex
import subprocess
import sys
from pathlib import Path

from floors import INTERVALS

QUIETARM = str(Path(sys.executable).parent / "quietarm")
MOVE = "single-link --target 30deg --duration 0.8"
TWO_TERMS = "--coefficients=0.003347,-0.1697"  # the paper's Table 1
COARSELY = [
    sys.executable,
    "-c",
    f"from quietarm.ocp.floor import energy_floor; energy_floor.FIRST_INTERVALS = {INTERVALS}\n"
    "from quietarm.views.report import progress; progress.PLAIN_SECONDS = 0.1\n"
    "from quietarm.__main__ import main; main()",
]
"""The command as a process, which says where a search is without delay, and finds coarser
floors.
"""


def run(line, **settings):
    """Run the installed command as a process of its own."""
    return subprocess.run(
        [QUIETARM, *shlex.split(line)], capture_output=True, text=True, timeout=120, **settings
    )
