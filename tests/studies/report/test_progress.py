"""Progress: a bar on a terminal, plain lines elsewhere, nothing when quiet."""

import io

from quietarm.studies.report.progress import progress
from rich.console import Console


def console(**settings):
    return Console(file=io.StringIO(), width=80, **settings)


def test_elsewhere_than_on_a_terminal_every_piece_is_one_plain_line():
    pipe = console()
    with progress(3, pipe) as begin:
        for name in ("arm, N = 2", "[bold]arm[/bold]", "arm, N = 6"):
            begin(name)
    assert pipe.file.getvalue() == "[1/3] arm, N = 2\n[2/3] [bold]arm[/bold]\n[3/3] arm, N = 6\n"
