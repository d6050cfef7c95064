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
from studies.cli import main
try:
    main(sys.argv[1:])
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
    assert not [name for name in found if name.startswith("studies.cli.commands")]


def test_the_help_of_a_command_loads_no_other(tmp_path):
    found = loaded("plan --help", tmp_path)
    assert found.isdisjoint(HEAVY)
    commands = [name for name in found if name.startswith("studies.cli.commands.")]
    assert sorted(commands) == ["studies.cli.commands.moves", "studies.cli.commands.moves.plan"]


@pytest.mark.parametrize(
    "line",
    [
        f"plan {MOVE} --terms 2 --starts 1 --output plan.json --csv move.csv",
        f"evaluate {MOVE} --coefficients=0,0",
        f"floor {MOVE} --acceleration-limit 200 --starts 1 --tolerance 0.1",
    ],
)
def test_the_gradient_loads_no_metaheuristic_and_no_picture(tmp_path, line):
    assert of_gradient(loaded(line, tmp_path))


def test_a_window_system_that_matplotlib_does_not_know_spoils_no_picture(tmp_path):
    ran = subprocess.run(
        [sys.executable, "-m", "studies", *f"evaluate {MOVE} --coefficients=0".split(),
         "--figure", str(tmp_path / "move.png")],
        capture_output=True, text=True, timeout=120, env={**os.environ, "MPLBACKEND": "nonsense"},
    )  # fmt: skip
    assert (ran.returncode, ran.stderr) == (0, "")
    assert (tmp_path / "move.png").exists()


@pytest.mark.parametrize(
    ("content", "said", "drawn"),
    [
        (b"foo.bar: 3\n", "matplotlib says: Bad key foo.bar in file matplotlibrc, line 1 "
         "('foo.bar: 3'); mend that line, or take it out", True),
        (b"font.family: Nope\n", "matplotlib says: findfont: Font family 'Nope' not found", True),
        (b"\xff\xfe", "matplotlib says: Cannot decode configuration file 'matplotlibrc' as utf-8\n"
         "quietarm: m.png cannot be drawn: matplotlibrc is no text in UTF-8; save it so, or take "
         "it away", False),
    ],
)  # fmt: skip
def test_a_matplotlibrc_that_is_broken_is_told_in_a_line(tmp_path, content, said, drawn):
    (tmp_path / "matplotlibrc").write_bytes(content)
    line = f"evaluate {MOVE} --coefficients=0 --quiet --output p.json --figure m.png"
    ran = subprocess.run(
        [sys.executable, "-m", "studies", *line.split()],
        cwd=tmp_path, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert (ran.stderr, ran.returncode) == (f"quietarm: {said}\n", 0 if drawn else 2)
    assert (tmp_path / "p.json").exists()
    assert (tmp_path / "m.png").exists() == drawn


@pytest.mark.parametrize(
    ("line", "needed"),
    [
        (f"evaluate {MOVE} --coefficients=0,0 --figure move.png", "matplotlib"),
        (f"plan {MOVE} --terms 0 --method vepso --bound 0.2", "pymoo"),
    ],
)
def test_what_is_asked_for_is_loaded(tmp_path, line, needed):
    """The tests above look for the right names: here they are."""
    ran = subprocess.run(
        [sys.executable, "-c", NOTED, *line.split()],
        cwd=tmp_path, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert needed in ran.stderr.split()


@pytest.mark.parametrize("line", ["front", "polish", "compare", "study", "reproduce"])
def test_help_of_what_searches_and_draws_waits_for_neither(tmp_path, line):
    assert of_gradient(loaded(f"{line} --help", tmp_path))
