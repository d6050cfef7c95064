"""Modules that a command loads: no more than it needs."""

import subprocess
import sys

import pytest

HEAVY = {"matplotlib", "moocore", "pymoo", "scipy"}
# At the end, whatever that is: the modules that are loaded.
NOTED = """
import sys
sys.argv[0] = "quietarm"
from quietarm.__main__ import main
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


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("line", ["--help", "front --help", "search --help"])
def test_help_loads_no_more_than_it_needs(tmp_path, line):
    found = loaded(line, tmp_path)
    assert found.isdisjoint(HEAVY)
    commands = [name for name in found if name.startswith("quietarm.studies.cli.commands.")]
    assert commands == [
        f"quietarm.studies.cli.commands.{name}_command" for name in line.split()[:-1]
    ]
