"""What a command loads: no more than it needs."""

import os
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


def test_importing_it_leaves_ctrl_c_to_the_program_that_imports_it(tmp_path):
    package = tmp_path / "program"
    package.mkdir()
    (package / "__init__.py").write_text("import quietarm.studies.cli.commands.plan\n")
    (package / "__main__.py").write_text(
        "import signal\n"
        "try:\n"
        "    signal.raise_signal(signal.SIGINT)\n"
        "except KeyboardInterrupt:\n"
        "    print('caught')\n"
    )
    path = os.pathsep.join([str(tmp_path), *sys.path])
    command = [sys.executable, "-m", "program"]
    ran = subprocess.run(
        command, env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True, timeout=120
    )
    assert (ran.returncode, ran.stdout, ran.stderr) == (0, "caught\n", "")


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="no such choice of cores here")
def test_workers_are_held_against_the_cores_that_the_process_may_use(tmp_path):
    # as a batch queue leaves a job one of the machine's cores
    one_core = (
        "import os; os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})\n"
        "from quietarm.studies.cli import main; main()"
    )
    line = f"front {MOVE} --method nsga2 --bound 0.2 --population 8 --generations 2 --runs 2"
    ran = subprocess.run(
        [sys.executable, "-c", one_core, *line.split(), "--workers", "2"],
        cwd=tmp_path, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert ran.returncode == 0
    assert "2 workers will share 1 core\n" in ran.stderr
