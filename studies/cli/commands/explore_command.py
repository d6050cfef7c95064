"""`quietarm explore`: a page on which a move is changed by hand."""

from __future__ import annotations

from pathlib import Path

import click

from quietarm.ocp.checks import install
from quietarm.studies.cli.given import Given
from quietarm.studies.cli.options import SET, command, option
from quietarm.studies.cli.plants import parse_plant


@command(
    click.Argument(["what"], required=False, metavar="[PLANT|plan.json|front.json|moves.zarr]"),
    SET,
    option("--no-browser", is_flag=True, help="Print the page's address alone."),
)
def explore(given: Given) -> None:
    """Show a page on which a move is changed by hand, and its figures and motion at once.

    It begins with the plain cycloid of a PLANT, single-link by default, with a saved plan or front,
    or with the moves of a sweep. Only this machine reaches the page; Ctrl-C ends it.

    \b
    Examples:
      quietarm explore
      quietarm explore dual-link
      quietarm explore plan.json --no-browser
    """  # noqa: D301  # \b is click's: do not rewrap
    from quietarm.studies.explore.start_page import is_file, open_file, open_plant

    try:
        from quietarm.studies.explore.server import serve
    except ImportError:
        raise ValueError(f"the page needs bokeh; {install('explore')}") from None

    what = given.what
    if what is not None and is_file(what):
        if given.parameters:
            raise ValueError(f"--set is for a PLANT, and {what} has its own; leave it out")
        explored = open_file(Path(what))
    else:
        of_file = what is None and given.plant_file is not None
        kind = None if of_file else parse_plant(what or "single-link")
        explored = open_plant(given.read_plant(kind))
    serve(explored, click.echo, not given.no_browser)
