"""What `from quietarm import metaheuristics` gives, and that it does not wait for pymoo."""

import subprocess
import sys

LIGHT = """
import sys
from quietarm import metaheuristics
from quietarm.metaheuristics import PRESETS, PopulationObjective, Spread, search, search_many
from quietarm.metaheuristics.ensemble import energies_at

assert "pymoo" not in sys.modules
from quietarm.metaheuristics import VEPSO

assert VEPSO.__module__ == "quietarm.metaheuristics.algorithms.vepso"
assert "pymoo" in sys.modules
"""


def test_pymoo_is_imported_with_what_builds_on_it_only():
    command = [sys.executable, "-c", LIGHT]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    assert (done.returncode, done.stderr) == (0, "")
