"""The page's server: this machine alone reaches it, at a port that is free.

Threads read requests and write answers; all motions are computed in the main thread, one after
another, so that Ctrl-C ends whatever it is at. Nothing is remembered of a visitor, a request has at
most 64 kB, and where many wait the next is refused.
"""

from __future__ import annotations

import base64
import hashlib
import re
import socketserver
import sys
import threading
import traceback
import warnings
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import suppress
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from queue import Empty, Full, Queue, SimpleQueue
from typing import Any

from quietarm.ocp import QuietarmError
from quietarm.ocp.escapes import one_line, script_json
from quietarm.views.explore.live_page import LivePage

_NAMES = ("localhost", "127.0.0.1", "[::1]")
"""What this machine is called in a browser. A name of the network that leads here belongs to a
stranger, whose page would read this one."""
_MOST_BYTES = 64_000
"""Of a question."""
_MOST_WAITING = 8
_MOST_CONNECTIONS = 64
_PATIENCE = 30.0
"""Seconds in which a request has to be sent."""
_TURN = 0.5
"""Seconds after which the main thread looks for Ctrl-C where a queue keeps it waiting (Windows)."""


def serve(page: LivePage, tell: Callable[[str], object], browser: bool = True) -> None:
    """Serve the page until Ctrl-C; `tell` is told its address."""
    desk = Desk(page)
    with suppress(KeyboardInterrupt), Listener(desk) as listener:
        threading.Thread(target=listener.serve_forever, daemon=True).start()
        try:
            address = f"http://127.0.0.1:{listener.server_address[1]}/"
            tell(address)
            tell("Ctrl-C ends it")
            if browser:  # in the text browser of a terminal, it stays until that ends
                threading.Thread(target=webbrowser.open, args=[address], daemon=True).start()
            while True:
                desk.work()
        finally:
            listener.shutdown()


class _AbandonedError(Exception):
    """Error when nobody waits for the answer any more."""


class Answering:
    """A question on its way: the lines of its answer come as they are known."""

    def __init__(self, path: str, body: bytes) -> None:
        self.path = path
        self.body = body
        self.is_abandoned = False
        self._lines = SimpleQueue[bytes]()

    def tell(self, **line: Any) -> None:
        """Send a line."""
        if self.is_abandoned:
            raise _AbandonedError
        self._lines.put(script_json(line).encode() + b"\n")

    def end(self) -> None:
        """Send no more."""
        self._lines.put(b"")

    def __iter__(self) -> Iterator[bytes]:
        return iter(self._lines.get, b"")


class Desk:
    """Queue of questions, which the main thread answers one after another."""

    def __init__(self, page: LivePage) -> None:
        self.page = page
        self.html = page.html()
        self.policy = _policy(self.html)
        self._waiting = Queue[Answering](_MOST_WAITING)

    def take(self, path: str, body: bytes) -> Answering | None:
        """Put a question on the pile; None where that is too high."""
        task = Answering(path, body)
        with suppress(Full):
            self._waiting.put_nowait(task)
            return task
        return None

    def work(self) -> None:
        """Answer the next question, if there is one within a moment."""
        try:
            task = self._waiting.get(timeout=_TURN)
        except Empty:
            return
        self._answer(task)

    def _answer(self, task: Answering) -> None:
        try:
            with warnings.catch_warnings(record=True) as warned:
                answer = self.page.answer(
                    task.path, task.body, lambda done, total: task.tell(done=done, total=total)
                )
            words = [one_line(str(warning.message)) for warning in warned]
            task.tell(**answer, warning="; ".join(dict.fromkeys(words)))
        except _AbandonedError:
            pass
        except (ValueError, QuietarmError) as error:
            with suppress(_AbandonedError):
                task.tell(error=one_line(str(error)))
        except Exception as error:
            traceback.print_exception(error)
            with suppress(_AbandonedError):
                task.tell(error="quietarm has failed; its terminal says where")
        finally:
            task.end()


def _policy(html: str) -> str:
    """Return the policy for the browser: run the page's own script, and ask its own server."""
    (script,) = re.findall(r"<script>(.*?)</script>", html, re.DOTALL)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return (
        f"default-src 'none'; script-src 'sha256-{digest}'; style-src 'unsafe-inline'; "
        "img-src data:; connect-src 'self'; base-uri 'none'; form-action 'none'; "
        "frame-ancestors 'none'"
    )


class Listener(ThreadingHTTPServer):
    """Listens at a free port of this machine alone."""

    daemon_threads = True
    request_queue_size = 128

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        super().__init__(("127.0.0.1", 0), _Handler)
        port = self.server_address[1]
        self.hosts = [f"{name}:{port}" for name in _NAMES]

    def server_bind(self) -> None:
        """Bind, without asking the network for a name of this machine."""
        socketserver.TCPServer.server_bind(self)

    def verify_request(self, request: Any, client_address: Any) -> bool:
        """Close the connection where there are very many."""
        return threading.active_count() < _MOST_CONNECTIONS

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of a browser that is gone."""
        if not isinstance(sys.exception(), OSError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    """One request of a browser."""

    server: Listener  # pyright: ignore[reportIncompatibleVariableOverride]
    timeout = _PATIENCE
    server_version = "quietarm"
    sys_version = ""

    def do_GET(self) -> None:  # the name that the standard library calls
        """Answer with the page."""
        if self._is_refused():
            return
        if self.path != "/":
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        content = self.server.desk.html.encode()
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", "text/html; charset=utf-8")
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def do_POST(self) -> None:
        """Answer a question of the page, in lines of JSON as they are known."""
        if self._is_refused() or self._is_of_another_page():
            return
        path = self.path.removeprefix("/")
        if path not in self.server.desk.page.paths:
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        length = self.headers.get("Content-Length", "")
        if not re.fullmatch("[0-9]{1,9}", length) or int(length) > _MOST_BYTES:
            self.send_error(HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
            return
        task = self.server.desk.take(path, self.rfile.read(int(length)))
        if task is None:
            self.send_error(HTTPStatus.SERVICE_UNAVAILABLE, "Many questions wait; ask again soon")
            return
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", "application/x-ndjson")
        self.end_headers()
        try:
            for line in task:
                self.wfile.write(line)
        finally:
            task.is_abandoned = True

    def end_headers(self) -> None:
        """Add what every answer says of itself."""
        self.send_header("Content-Security-Policy", self.server.desk.policy)
        self.send_header("Cache-Control", "no-store")
        self.send_header("Cross-Origin-Resource-Policy", "same-origin")
        self.send_header("X-Content-Type-Options", "nosniff")
        super().end_headers()

    def _is_refused(self) -> bool:
        """Refuse requests to another name than one of this machine's."""
        if self.headers.get("Host", "").lower() in self.server.hosts:
            return False
        self.send_error(HTTPStatus.FORBIDDEN, "Open it as localhost")
        return True

    def _is_of_another_page(self) -> bool:
        """Refuse what another page of the browser asks, or a form of it."""
        own = f"http://{self.headers['Host']}".lower()
        is_json = self.headers.get_content_type() == "application/json"
        if self.headers.get("Origin", "").lower() == own and is_json:
            return False
        self.send_error(HTTPStatus.FORBIDDEN, "Ask from the page itself")
        return True

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002
        """Say nothing: requests are no news for the user."""
