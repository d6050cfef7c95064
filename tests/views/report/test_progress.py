"""Progress: a bar on a terminal, plain lines elsewhere, nothing when quiet."""

import io
import re
import time
from functools import partial

import pytest
from rich.console import Console

from quietarm.metaheuristics import SearchProgress
from quietarm.views.report import progress as shown
from quietarm.views.report.progress import count, progress, search_display, working


def console(**settings):
    return Console(file=io.StringIO(), width=80, **settings)


def test_elsewhere_than_on_a_terminal_every_piece_is_one_plain_line():
    pipe = console()
    with progress(3, pipe) as begin:
        for name in ("arm, N = 2", "[bold]arm[/bold]", "arm, N = 6"):
            begin(name)
    assert pipe.file.getvalue() == "[1/3] arm, N = 2\n[2/3] [bold]arm[/bold]\n[3/3] arm, N = 6\n"


@pytest.mark.parametrize("show", [working, partial(count, 7)])
def test_where_there_is_no_terminal_long_work_says_what_it_is_at(monkeypatch, show):
    monkeypatch.setattr(shown, "SILENT_SECONDS", 0.01)
    pipe = console()
    with show("solving", pipe):
        limit = time.monotonic() + 60  # only guards against hanging
        while "\n" not in pipe.file.getvalue() and time.monotonic() < limit:
            time.sleep(0.01)
    assert re.match(r"still (working on 7 )?solving after \d+ s\n", pipe.file.getvalue())


def test_quiet_work_says_nothing(monkeypatch):
    monkeypatch.setattr(shown, "SILENT_SECONDS", 0.001)
    pipe = console(quiet=True)
    with working("solving", pipe):
        time.sleep(0.05)
    assert pipe.file.getvalue() == ""


def test_a_line_of_a_search_fits_into_a_hundred_columns():
    pipe = console()
    with search_display(pipe) as display:
        display(
            SearchProgress(
                100_000, 100_000, 12.345, 0.0447, 0.653, 5_000_000, 3600.0, infeasible=1_000_000,
                names=("settling time of the tip", "work of the drive"), step="candidate",
            )
        )  # fmt: skip
    lines = pipe.file.getvalue().splitlines()
    assert max(map(len, lines)) <= 100
    assert lines[0].startswith("candidate 100000/100000, ")
    assert "hypervolume 0.6530" in " ".join(lines)
