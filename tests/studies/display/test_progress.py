"""Progress: a bar on a terminal, plain lines elsewhere, nothing when quiet."""

import io

import pytest
from quietarm.studies.display.progress import count, progress
from rich.console import Console


def console(**settings):
    return Console(file=io.StringIO(), width=80, **settings)


def test_elsewhere_than_on_a_terminal_every_piece_is_one_plain_line():
    pipe = console()
    with progress(3, pipe) as begin:
        for name in ("arm, N = 2", "[bold]arm[/bold]", "arm, N = 6"):
            begin(name)
    assert pipe.file.getvalue() == "[1/3] arm, N = 2\n[2/3] [bold]arm[/bold]\n[3/3] arm, N = 6\n"


def test_a_line_is_not_broken_however_narrow_the_console_is():
    pipe = Console(file=io.StringIO(), width=30)
    name = "arm-on-flexible-link, -pi/2 to pi/4, 1.0 s, N = 6, in the box"
    with progress(1, pipe) as begin:
        begin(name)
    assert pipe.file.getvalue() == f"[1/1] {name}\n"


def test_a_line_is_out_when_its_piece_begins_not_when_it_ends():
    pipe = console()
    with progress(2, pipe) as begin:
        begin("first")
        assert pipe.file.getvalue() == "[1/2] first\n"


def test_a_terminal_shows_a_bar_that_counts_finished_pieces_and_goes_away():
    terminal = console(force_terminal=True)
    with progress(2, terminal) as begin:
        begin("first")
        begin("second [x]")
    text = terminal.file.getvalue()
    assert "\x1b[" in text  # drawn in place
    assert "1/2" in text
    assert "second [x]" in text
    assert "2/2" not in text  # the second was begun, never reported as finished
    assert text.endswith("\x1b[2K")  # the last line is erased


@pytest.mark.parametrize("terminal", [True, False])
def test_quiet_shows_nothing(terminal):
    silent = console(force_terminal=terminal)
    with progress(2, silent, quiet=True) as begin:
        begin("first")
    assert silent.file.getvalue() == ""


@pytest.mark.parametrize("terminal", [True, False])
@pytest.mark.parametrize("quiet", [True, False])
def test_an_error_inside_passes_through(terminal, quiet):
    def work():
        with progress(2, console(force_terminal=terminal), quiet=quiet) as begin:
            begin("first")
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        work()


# Many small pieces


def test_counts_are_a_bar_on_a_terminal_and_nothing_when_quiet():
    terminal, silent = console(force_terminal=True), console(force_terminal=True)
    with count(4, "points", terminal) as report, count(4, "points", silent, quiet=True) as none:
        report(3, 4)
        none(3, 4)
    assert "3/4" in terminal.file.getvalue()
    assert silent.file.getvalue() == ""
