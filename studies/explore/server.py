"""The page's server: this machine alone reaches it, at a port that is free."""

from __future__ import annotations

import logging
import webbrowser
from collections.abc import Callable
from contextlib import suppress

from bokeh.document import Document
from bokeh.server.server import Server
from quietarm.studies.explore.move import Explored
from quietarm.studies.explore.opening import menu
from quietarm.studies.explore.page import Page


def serve(explored: Explored, tell: Callable[[str], object], browser: bool = True) -> None:
    """Show the page, which begins with `explored`, until Ctrl-C, of which `tell` tells."""
    plants = menu(explored.task.plant)

    def fill(document: Document) -> None:
        Page(document, explored, plants)

    # a page that was closed is no error
    logging.getLogger("bokeh").setLevel(logging.ERROR)
    server = Server({"/": fill}, port=0, address="127.0.0.1")
    server.start()
    address = f"http://localhost:{server.port}/"
    tell(address)
    tell("Ctrl-C ends it")
    if browser:
        server.io_loop.add_callback(webbrowser.open, address)
    with suppress(KeyboardInterrupt):
        server.io_loop.start()
    server.stop()
