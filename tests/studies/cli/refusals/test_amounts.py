"""Amounts that would fill the memory are refused; work that takes long says so."""

import re
import subprocess
import sys
from itertools import islice

import pytest
from lines import MOVE
from quietarm.studies.display import progress

FRONT = f"front {MOVE} --bound 0.2 --method"
HUGE = "100000000000"


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (f"plan {MOVE} --starts {HUGE}", "give at most 10000: each is a solve"),
        (f"floor {MOVE} --starts {HUGE}", "give at most 10000: each is a solve"),
        (f"{FRONT} epsilon --starts {HUGE}", "give at most 10000: each is a solve"),
        (f"{FRONT} epsilon --points {HUGE}", "give at most 10000: 50 show a front"),
        (f"{FRONT} weighted --points {HUGE}", "give at most 10000: 50 show a front"),
        (f"{FRONT} nsga2 --runs 2 --workers {HUGE}", "give at most 1000: each is a process"),
        (f"{FRONT} nsga2 --runs {HUGE}", "give at most 10000: the fronts of more"),
        (f"{FRONT} nsga2 --population {HUGE}", "give at most 100000: 100000 take 1.6 GB"),
        (f"{FRONT} vepso --generations {HUGE}", "give at most 1000000: the longest"),
        (f"study {MOVE} --points {HUGE}", "give at most 10000: 50 show a front"),
        (f"study {MOVE} --runs {HUGE}", "give at most 10000: the fronts of more"),
        (f"study {MOVE} --workers {HUGE}", "give at most 1000: each is a process"),
        (f"study {MOVE} --population {HUGE}", "give at most 100000: 100000 take 1.6 GB"),
        (f"reproduce --seeds {HUGE}", "give at most 10000: the fronts of more"),
    ],
)
def test_an_amount_beyond_all_reason_is_refused_with_one_before_any_work(call, folder, line, words):
    code, out, err = call(f"{line} --quiet")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert f" is {HUGE}; {words}" in err
    assert list(folder.iterdir()) == []


def test_a_long_move_is_not_told_of_a_rate_that_nobody_gave(call):
    code, _, err = call("plan single-link --target 1 --duration 1e6")
    assert code == 2
    assert "rate" not in err
    assert "radians of the plant's fastest mode" in err
    assert "give a shorter duration" in err


def test_a_table_that_would_be_too_long_is_refused_first(call):
    code, _, err = call("plan single-link --target 1 --duration 1e6 --csv move.csv")
    assert (code, err.count("\n")) == (2, 1)
    assert "asks for 1000000000 rows; give a lower rate" in err


# Silence

SLOW = """
import time
import quietarm.studies.cli
import quietarm.studies.cli.commands.moves.plan as command
import quietarm.studies.display.progress as progress

assert progress.SILENT_SECONDS == 2.0
progress.SILENT_SECONDS = 0.01
solve = command.plan_move

def slow(*given, **settings):
    while not said:
        time.sleep(0.01)
    return solve(*given, **settings)

said = []
say = progress.print_lines

def noted(console, *lines):
    said.append(lines)
    say(console, *lines)

progress.print_lines = noted
command.plan_move = slow
quietarm.studies.cli.main()
"""


def test_work_that_takes_long_says_so():
    ran = subprocess.run(
        [sys.executable, "-c", SLOW, *f"plan {MOVE} --terms 2 --starts 1".split()],
        capture_output=True, text=True, timeout=240, check=False,
    )  # fmt: skip
    assert ran.returncode == 0
    assert re.match(r"solving, \d+ s so far\n", ran.stderr)
    assert "so far" not in ran.stdout


@pytest.mark.parametrize("line", [f"evaluate {MOVE} --coefficients=0", f"plan {MOVE} --starts 1"])
def test_quiet_is_quiet_from_the_first_moment(call, monkeypatch, line):
    def fail(*given):
        pytest.fail("something was to be shown")

    monkeypatch.setattr(progress, "ticking", fail)
    assert call(f"{line} --quiet")[2] == ""


def test_pauses_between_words_grow():
    assert list(islice(progress.pauses(), 8)) == [2, 4, 8, 16, 32, 60, 60, 60]
