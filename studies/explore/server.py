"""The page's server: this machine alone reaches it, at a port that is free."""

from __future__ import annotations

import logging
import time
import webbrowser
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from bokeh.document import Document
from bokeh.server.server import BaseServer
from bokeh.server.tornado import BokehTornado
from bokeh.server.util import bind_sockets
from tornado.httpserver import HTTPServer
from tornado.httputil import HTTPServerRequest
from tornado.ioloop import IOLoop
from tornado.routing import Matcher, Rule
from tornado.web import RequestHandler

from quietarm.studies.explore.move import Explored
from quietarm.studies.explore.page import Page
from quietarm.studies.explore.start_page import menu

_HOSTS = ("localhost", "127.0.0.1", "[::1]")
"""What this machine is called in a browser. A name of the network that leads here belongs to a
stranger, whose page would read this one."""
_MOST_PAGES = 10
_WHILE = 15.0
"""So many pages are made in so many seconds: each takes some 0.3 s, in which no other moves."""


def serve(explored: Explored, tell: Callable[[str], object], browser: bool = True) -> None:
    """Show the page, which begins with `explored`, until Ctrl-C, of which `tell` tells."""
    plants = menu(explored.task.plant)

    def fill(document: Document) -> None:
        Page(document, explored, plants)

    # a page that was closed is no error
    logging.getLogger("bokeh").setLevel(logging.ERROR)
    logging.getLogger("bokeh.server.views.ws").setLevel(logging.CRITICAL)  # of refused sockets
    logging.getLogger("tornado.application").addFilter(_is_no_broken_socket)
    server, port = _server(fill)
    server.start()
    address = f"http://localhost:{port}/"
    tell(address)
    tell("Ctrl-C ends it")
    if browser:
        server.io_loop.add_callback(webbrowser.open, address)
    with suppress(KeyboardInterrupt):
        server.io_loop.start()
    server.stop()


def _server(fill: Callable[[Document], None]) -> tuple[BaseServer, int]:
    """A server of one page that answers this machine's names alone, and its port."""
    sockets, port = bind_sockets("127.0.0.1", 0)
    origins = [f"{host}:{port}" for host in _HOSTS]
    quiet: Any = {"log_function": lambda handler: None}  # refusals are no news for the user
    application = BokehTornado({"/": fill}, extra_websocket_origins=origins, **quiet)
    listener = HTTPServer(application)
    server = BaseServer(IOLoop.current(), application, listener)
    refusals = [
        Rule(_Stranger(), _Refusal, {"status": 403, "reason": "Open it as localhost"}),
        Rule(_Crowd(), _Refusal, {"status": 503, "reason": "Too many pages; reload soon"}),
    ]
    application.add_handlers(".*", refusals)  # before what bokeh answers, sockets too
    listener.add_sockets(sockets)
    return server, port


def _is_no_broken_socket(record: logging.LogRecord) -> bool:
    """Whether this is other news than that a program asked for the socket in a way of its own."""
    return not ("Uncaught" in str(record.msg) and "/ws" in str(record.args))


class _Stranger(Matcher):
    """Requests to another name than one of this machine's."""

    def match(self, request: HTTPServerRequest) -> dict[str, Any] | None:
        return None if request.host_name in _HOSTS else {}


class _Crowd(Matcher):
    """Requests for more pages than are made in a while."""

    def __init__(self) -> None:
        self._pages = deque[float](maxlen=_MOST_PAGES)

    def match(self, request: HTTPServerRequest) -> dict[str, Any] | None:
        if request.path not in ("/", "/autoload.js"):
            return None
        now = time.monotonic()
        if len(self._pages) == _MOST_PAGES and now - self._pages[0] < _WHILE:
            return {}
        self._pages.append(now)
        return None


class _Refusal(RequestHandler):
    """Says in a line why there is no page."""

    def initialize(self, status: int, reason: str) -> None:
        self._answer = status, reason

    def prepare(self) -> None:
        """Answer a request of any kind."""
        self.send_error(self._answer[0], reason=self._answer[1])
