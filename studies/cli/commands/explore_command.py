"""`quietarm explore`: a page on which a move is changed by hand."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from quietarm.studies.cli.given import Given
from quietarm.studies.cli.options import SET, command, option
from quietarm.studies.cli.plants import parse_plant

if TYPE_CHECKING:
    from quietarm.views.explore.by_hand import MoveByHand


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
    from quietarm.studies.answers.open_by_hand import is_file, open_file
    from quietarm.studies.reproduce.paper import paper_points
    from quietarm.views.explore.by_hand import open_plant
    from quietarm.views.explore.live_page import LivePage
    from quietarm.views.explore.server import serve

    def begun() -> MoveByHand:
        what = given.what
        if what is not None and is_file(what):
            if given.parameters:
                raise ValueError(f"--set is for a PLANT, and {what} has its own; leave it out")
            return open_file(Path(what))
        of_file = what is None and given.plant_file is not None
        kind = None if of_file else parse_plant(what or "single-link")
        return open_plant(given.read_plant(kind))

    serve(LivePage(begun(), paper_points), click.echo, not given.no_browser)
