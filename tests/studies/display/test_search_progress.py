"""How searches are shown: bars on a terminal, plain lines elsewhere, nothing when quiet."""

import io
import math
import re
import time
from dataclasses import replace
from itertools import repeat

import pytest
import quietarm.studies.display.progress
import quietarm.studies.display.search_progress
from quietarm.metaheuristics import SearchProgress
from quietarm.ocp import Generation
from quietarm.studies.display.search_progress import search_display
from rich.console import Console

# 120 of 500 generations in 3 s: 380 are left, at 40 a second 9.5 s
NOW = SearchProgress(
    generation=120, generations=500, residual=1.23e-4, energy=0.0523, hypervolume=0.81234,
    evaluations=24_000, seconds=3.0,
)  # fmt: skip
END = replace(NOW, generation=500, evaluations=100_000, seconds=12.5)


def console(**settings):
    return Console(file=io.StringIO(), **{"width": 140, **settings})


def drawn(terminal):
    """The last picture on a terminal, without the codes that draw it in place."""
    frame = terminal.file.getvalue().split("\x1b[2K")[-1]
    return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", frame)


@pytest.fixture
def clock(monkeypatch):
    """A clock that a test sets, for the plain lines."""
    now = [0.0]
    monkeypatch.setattr(
        quietarm.studies.display.search_progress.time, "perf_counter", lambda: now[0]
    )
    return now


def test_a_terminal_shows_all_figures_with_their_names():
    terminal = console(force_terminal=True)
    with search_display(terminal) as display:
        display(NOW)
        display._bars.refresh()
        shown = drawn(terminal)
    assert shown.startswith("━━")
    for text in (
        "generation 120/500", "residual 0.123 mm", "energy 0.0523 J", "hypervolume 0.8123",
        "8000 candidates/s", "10 s left",
    ):  # fmt: skip
        assert text in shown
    assert drawn(terminal).strip() == ""  # it goes away


@pytest.mark.parametrize("seed", [None, 11])
def test_a_narrow_terminal_shows_them_all_on_one_line(seed):
    terminal = console(width=80, force_terminal=True)
    slow = replace(NOW, residual=1.23e-8, seconds=1200.0)  # 63 min left
    with search_display(terminal) as display:
        display(slow, seed)
        display._bars.refresh()
        shown = drawn(terminal).strip()
    assert "\n" not in shown
    assert shown.endswith(
        "seed 11 " * (seed is not None) + "120/500 1.2e-05 mm 0.0523 J hv 0.812 20/s 63 min left"
    )


def test_every_running_seed_has_a_bar_until_it_is_done(front_of):
    terminal = console(force_terminal=True)
    with search_display(terminal) as display:
        display(NOW, 3)
        display(NOW, 4)
        display._bars.refresh()
        both = drawn(terminal)
        display.finish(front_of([(1, 0.2)], seed=3, history=(Generation(9, 0.25),), seconds=2.0))
        display._bars.refresh()
        one = drawn(terminal)
    assert "seed 3, generation" in both
    assert "seed 4, generation" in both
    assert "seed 3, generation" not in one
    assert "seed 4, generation" in one
    assert "seed 3 is done: hypervolume 0.2500 in 2.0 s" in terminal.file.getvalue()


def test_elsewhere_a_line_comes_every_two_seconds_and_at_the_end(clock):
    pipe = console(width=40)
    with search_display(pipe) as display:
        for clock[0] in (0.5, 2.4, 2.6, 3.0, 4.5, 4.7):
            display(NOW)
        clock[0] = 4.8
        display(END)
    line = (
        "generation 120/500, residual 0.123 mm, energy 0.0523 J, hypervolume 0.8123, "
        "8000 candidates/s, 10 s left\n"
    )
    last = line.replace("120", "500", 1).replace("10 s", "0 s")
    assert pipe.file.getvalue() == line + line + last


def test_elsewhere_every_seed_has_its_lines(clock, front_of):
    pipe = console()
    with search_display(pipe) as display:
        for clock[0], seed in ((0.5, 0), (2.2, 1), (2.7, 0), (3.0, 0), (4.3, 1)):
            display(NOW, seed)
        display.finish(front_of([(1, 0.2)], seed=0, history=(Generation(9, 0.5),), seconds=3.04))
    first, second, done = pipe.file.getvalue().splitlines()
    assert first.startswith("seed 0, generation 120/500, ")
    assert second.startswith("seed 1, generation 120/500, ")
    assert done == "seed 0 is done: hypervolume 0.5000 in 3.0 s"


def test_a_search_that_found_nothing_yet_says_so(clock):
    pipe = console()
    nothing = replace(END, residual=math.nan, energy=math.nan, hypervolume=0.0, infeasible=75_000)
    with search_display(pipe) as display:
        display(nothing)
    assert pipe.file.getvalue() == (
        "generation 500/500, nothing found yet, hypervolume 0.0000, 8000 candidates/s "
        "(75% break a limit), 0 s left\n"
    )


@pytest.mark.parametrize("terminal", [True, False])
def test_quiet_shows_nothing(terminal, front_of):
    silent = console(force_terminal=terminal)
    with search_display(silent, quiet=True) as display:
        display(END)
        display(END, 3)
        display.finish(front_of([(1, 0.2)]))
    assert silent.file.getvalue() == ""


def test_before_the_first_line_it_says_that_it_begins(monkeypatch):
    # as while workers start
    monkeypatch.setattr(quietarm.studies.display.progress, "pauses", lambda: repeat(0.01))
    pipe = console()
    with search_display(pipe) as display:
        for _ in range(1000):
            if pipe.file.getvalue():
                break
            time.sleep(0.01)
        display(NOW)
        said = pipe.file.getvalue()
        time.sleep(0.1)
    assert re.match(r"beginning, \d+ s so far\n", said)
    assert len(pipe.file.getvalue()) - len(said) <= len("beginning, 0 s so far\n")
