"""What a command loads: no more than it needs."""

import subprocess
import sys

import pytest

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


def test_help_and_version_load_no_command(tmp_path):
    found = loaded("--help", tmp_path)
    assert found.isdisjoint(HEAVY)
    assert not [name for name in found if name.startswith("quietarm.studies.cli.commands")]


@pytest.mark.parametrize("line", ["front", "search"])
def test_help_of_what_searches_and_draws_waits_for_neither(tmp_path, line):
    assert of_gradient(loaded(f"{line} --help", tmp_path))
