"""What a command loads: no more than it needs."""

import subprocess
import sys

import pytest
from lines import MOVE

HEAVY = {"matplotlib", "moocore", "pymoo", "scipy"}
# At the end, whatever that is: the modules that are loaded.
NOTED = """
import sys
sys.argv[0] = "quietarm"
from quietarm.studies.cli import main
try:
    main()
finally:
    print(*sys.modules, file=sys.stderr)
"""


def loaded(line, folder):
    """The modules that are loaded when a command has ended, in a process of its own."""
    ran = subprocess.run(
        [sys.executable, "-c", NOTED, *line.split()],
        cwd=folder, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert ran.returncode == 0, ran.stderr
    return set(ran.stderr.split())


def of_gradient(found):
    """Of the metaheuristics only the names of the methods, which the options offer."""
    rooms = {name.split(".")[1] for name in found if name.startswith("metaheuristics.")}
    return found.isdisjoint(HEAVY) and rooms <= {"algorithms", "runs", "search"}


@pytest.mark.parametrize("line", ["--help", "--version"])
def test_help_and_version_load_no_command(tmp_path, line):
    found = loaded(line, tmp_path)
    assert found.isdisjoint(HEAVY)
    assert not [name for name in found if name.startswith("quietarm.studies.cli.commands")]


def test_what_is_asked_for_is_loaded(tmp_path):
    """The tests above look for the right name: here it is."""
    ran = subprocess.run(
        [sys.executable, "-c", NOTED, *f"plan {MOVE} --terms 0 --method vepso --bound 0.2".split()],
        cwd=tmp_path, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert "pymoo" in ran.stderr.split()


@pytest.mark.parametrize("line", ["front", "polish", "compare", "study", "reproduce"])
def test_help_of_what_searches_and_draws_waits_for_neither(tmp_path, line):
    assert of_gradient(loaded(f"{line} --help", tmp_path))
