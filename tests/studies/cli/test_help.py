"""Help: every command has examples, and they are read without complaint."""

import re
import subprocess
import sys

import pytest
import quietarm.studies.cli.commands.moves.evaluate
import quietarm.studies.cli.commands.moves.floor
import quietarm.studies.cli.commands.moves.plan
import quietarm.studies.contest.imported
import quietarm.studies.contest.work
import quietarm.studies.reproduction.recompute
import quietarm.studies.runs.animating
import quietarm.studies.runs.foreign
import quietarm.studies.runs.loading
import quietarm.studies.runs.polishing
import quietarm.studies.runs.problems
import quietarm.studies.runs.robustness
import quietarm.studies.runs.searching
import quietarm.studies.study.work
from lines import QUIETARM
from quietarm.models import __version__
from quietarm.ocp import InfeasibleTaskError
from quietarm.studies.cli import quietarm as command_line

COMMANDS = sorted(command_line.commands)


def examples(text):
    """The commands of a help text, each on a line of its own."""
    lines = re.sub(r" \\\n +", " ", text.split("Example", 1)[1]).splitlines()
    return [line.strip() for line in lines if line.strip().startswith("quietarm ")]


@pytest.mark.parametrize("command", ["", *COMMANDS])
@pytest.mark.parametrize("flag", ["-h", "--help"])
def test_help_shows_examples(call, command, flag):
    code, out, err = call(f"{command} {flag}")
    assert (code, err) == (0, "")
    assert "Example" in out
    assert any(shown.startswith(f"quietarm {command}") for shown in examples(out))
    assert "\\b" not in out  # click's mark for lines that it must not fill


def test_help_names_every_option(call):
    _, out, _ = call("plan --help")
    options = (
        "start target duration terms bound residual-limit torque-limit speed-limit jerk-limit "
        "acceleration-limit deflection-limit starts seed output csv figure robust"
    )
    for option in options.split():
        assert f"--{option}" in out


def test_no_command_is_answered_with_help(call):
    code, out, err = call("")
    assert code == 2
    assert "quietarm plan single-link" in out
    assert err == ""


@pytest.mark.parametrize("launcher", [[QUIETARM], [sys.executable, "-m", "quietarm"]])
def test_the_installed_command_says_its_version(launcher):
    ran = subprocess.run([*launcher, "--version"], capture_output=True, text=True, timeout=60)
    assert (ran.returncode, ran.stdout, ran.stderr) == (0, f"quietarm, version {__version__}\n", "")


@pytest.mark.parametrize("command", ["", *COMMANDS])
def test_examples_in_the_help_are_read_without_complaint(
    call, monkeypatch, let_sweep, folder, command
):
    _, out, _ = call(f"{command} --help")
    reached = []

    def note(*arguments, **settings):
        reached.append(settings)
        raise InfeasibleTaskError("enough is known")

    monkeypatch.setattr(quietarm.studies.cli.commands.moves.plan, "plan_move", note)
    monkeypatch.setattr(quietarm.studies.cli.commands.moves.evaluate, "evaluate_coefficients", note)
    monkeypatch.setattr(quietarm.studies.runs.searching, "search", note)
    monkeypatch.setattr(quietarm.studies.runs.searching, "search_many", note)
    monkeypatch.setattr(quietarm.studies.runs.loading, "load_front", note)
    monkeypatch.setattr(quietarm.studies.runs.polishing, "run_polish", note)
    monkeypatch.setattr(quietarm.studies.runs.animating, "run_animate", note)
    monkeypatch.setattr(quietarm.studies.runs.problems, "run_problems", note)
    monkeypatch.setattr(quietarm.studies.runs.foreign, "read_found", note)
    monkeypatch.setattr(quietarm.studies.runs.robustness, "run_robustness", note)
    monkeypatch.setattr(quietarm.studies.study.work, "run_study", note)
    monkeypatch.setattr(quietarm.studies.contest.imported, "named_files", lambda given: {})
    monkeypatch.setattr(quietarm.studies.contest.work, "set_up", note)
    monkeypatch.setattr(quietarm.studies.cli.commands.moves.floor, "energy_floor", note)
    for name in ("epsilon", "weighted"):
        let_sweep(name, note)
    monkeypatch.setattr(quietarm.studies.reproduction.recompute, "recompute_paper", note)
    shown = examples(out)
    assert shown
    for example in shown:
        code, _, err = call(example.removeprefix("quietarm "))
        assert (code, err.splitlines()[-1]) == (1, "quietarm: enough is known")
    assert len(reached) == len(shown)
