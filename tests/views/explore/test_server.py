"""Whom the page's server answers: this machine by its own names, its own page, and in turn."""

import http.client
import json
import re
import signal
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager

import pytest

from quietarm.views.explore.server import Desk, Listener

GUARD = 240
"""Seconds after which what does not come has hung, on any machine."""


class Page:
    """A page that needs no motion: it answers what it is told to."""

    paths = frozenset({"motion", "front"})

    def __init__(self):
        self.bodies = []
        self.entered = threading.Event()
        self.may_end = threading.Event()
        self.may_end.set()
        self.ended = []

    def html(self):
        return "<!doctype html><title>page</title><script>let x = 1;</script>"

    def answer(self, path, body, report):
        self.bodies.append(body)
        self.entered.set()
        assert self.may_end.wait(GUARD)
        words = body.decode()
        if words == "refuse":
            raise ValueError("no move\nat all; give one")
        if words == "fail":
            raise RuntimeError("broken")
        if words == "many":
            try:
                for done in range(100_000):
                    report(done, 100_000)
            finally:
                self.ended.append(done)
        return {"path": path, "text": "</script>\u202e"}


@contextmanager
def served(page):
    """A server whose questions are answered by a thread in place of the main one."""
    desk = Desk(page)
    stop = threading.Event()

    def work():
        while not stop.is_set():
            desk.work()

    worker = threading.Thread(target=work)
    with Listener(desk) as listener:
        listening = threading.Thread(target=listener.serve_forever, kwargs={"poll_interval": 0.01})
        listening.start()
        worker.start()
        try:
            yield listener.server_address[1]
        finally:
            page.may_end.set()
            stop.set()
            listener.shutdown()
            worker.join()
            listening.join()


@pytest.fixture
def page():
    return Page()


@pytest.fixture
def port(page):
    with served(page) as number:
        yield number


def request(port, method, path, headers, body=b""):
    """Status, headers and text of an answer."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=GUARD)
    connection.putrequest(method, path, skip_host=True)
    for name, value in headers.items():
        connection.putheader(name, value.replace("PORT", str(port)))
    connection.endheaders(body)
    answer = connection.getresponse()
    text = answer.read().decode()
    connection.close()
    return answer.status, answer.headers, text


def get(port, host, path="/"):
    return request(port, "GET", path, {"Host": host})[0]


OWN = {
    "Host": "127.0.0.1:PORT", "Origin": "http://127.0.0.1:PORT", "Content-Type": "application/json",
}  # fmt: skip


def post(port, path="/motion", body=b"{}", **changes):
    headers = {**OWN, "Content-Length": str(len(body)), **changes}
    headers = {name.replace("_", "-"): value for name, value in headers.items() if value}
    return request(port, "POST", path, headers, body)


@pytest.mark.parametrize(
    "host", ["localhost:PORT", "127.0.0.1:PORT", "[::1]:PORT", "LocalHost:PORT"]
)
def test_it_answers_to_this_machines_names(port, host):
    assert get(port, host) == 200
    assert post(port, Host=host, Origin=f"http://{host}")[0] == 200


@pytest.mark.parametrize(
    "host",
    ["evil.example:PORT", "localhost.evil.example", "evil.localhost:PORT", "localhost", "",
     "127.0.0.1.evil.example:PORT", "localhost.:PORT", "0.0.0.0:PORT", "127.1:PORT"],
)  # fmt: skip
def test_it_refuses_a_name_that_was_led_here(port, page, host):
    for path in ("/", "/motion", "/none"):
        assert get(port, host, path) == 403
        assert post(port, path, Host=host)[0] == 403
        assert post(port, path, Host=host, Origin=f"http://{host}")[0] == 403
    assert page.bodies == []


@pytest.mark.parametrize(
    "headers",
    [{"Origin": "http://evil.example:PORT"}, {"Origin": "http://localhost:1"}, {"Origin": "null"},
     {"Origin": ""}, {"Origin": "https://127.0.0.1:PORT"}, {"Content_Type": "text/plain"},
     {"Content_Type": "application/x-www-form-urlencoded"}, {"Content_Type": ""}],
)  # fmt: skip
def test_another_page_of_this_browser_asks_nothing(port, page, headers):
    changes = {"Content-Type" if name == "Content_Type" else name: value
               for name, value in headers.items()}  # fmt: skip
    assert post(port, **changes)[0] == 403
    assert page.bodies == []


def test_the_page_may_run_its_own_script_and_ask_its_own_server(port):
    status, headers, text = request(port, "GET", "/", {"Host": "localhost:PORT"})
    assert (status, text.startswith("<!doctype html>")) == (200, True)
    policy = headers["Content-Security-Policy"]
    # printf 'let x = 1;' | openssl dgst -sha256 -binary | base64
    assert "script-src 'sha256-qtc3jf64UXA5J6U02kfQ0Cvn9Uz4wXUaN3NNUVgR2v4='" in policy
    assert "default-src 'none'" in policy
    assert "frame-ancestors 'none'" in policy
    assert headers["Cross-Origin-Resource-Policy"] == "same-origin"


def test_an_answer_is_lines_of_json_that_end_no_script(port):
    status, headers, text = post(port)
    assert (status, headers["Content-Type"]) == (200, "application/x-ndjson")
    assert "</script>" not in text
    assert json.loads(text) == {"path": "motion", "text": "</script>?", "warning": ""}


def test_what_has_no_answer_is_said_in_a_line_and_the_next_question_is_answered(port, capfd):
    assert json.loads(post(port, body=b"refuse")[2]) == {"error": "no move at all; give one"}
    assert "quietarm has failed" in json.loads(post(port, body=b"fail")[2])["error"]
    assert "RuntimeError: broken" in capfd.readouterr().err
    assert json.loads(post(port)[2])["path"] == "motion"
    assert post(port, "/none")[0] == 404
    assert get(port, "localhost:PORT", "/motion") == 404


@pytest.mark.parametrize("length", ["64001", "999999999999", "-1", "1e3", ""])
def test_what_is_too_long_or_of_no_length_is_not_read(port, page, length):
    assert post(port, **{"Content-Length": length})[0] == 413
    assert page.bodies == []


def test_many_questions_at_once_are_told_to_wait(port, page):
    page.may_end.clear()
    with ThreadPoolExecutor(20) as visitors:
        asked = [visitors.submit(post, port) for _ in range(20)]
        assert page.entered.wait(GUARD)
        refused = next(as_completed(asked, timeout=GUARD)).result()[0]
        page.may_end.set()
        statuses = {one.result()[0] for one in asked}
    assert refused == 503
    assert statuses == {200, 503}
    assert post(port)[0] == 200


def test_what_nobody_waits_for_is_given_up(port, page):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=GUARD)
    headers = {name: value.replace("PORT", str(port)) for name, value in OWN.items()}
    page.may_end.clear()
    connection.request("POST", "/front", b"many", headers)
    answer = connection.getresponse()
    page.may_end.set()
    assert json.loads(answer.readline()) == {"done": 0, "total": 100_000}
    answer.close()
    connection.close()
    assert post(port)[0] == 200
    assert page.ended[0] < 99_999


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("while_it_computes", [False, True])
def test_ctrl_c_ends_it_whatever_it_is_at(while_it_computes):
    line = [sys.executable, "-W", "error", "-m", "quietarm", "explore", "--no-browser"]
    process = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        port = int(re.search(r":(\d+)/", process.stdout.readline())[1])
        # read here: communicate loses what readline has read ahead
        assert process.stdout.readline() == "Ctrl-C ends it\n"
        assert get(port, "localhost:PORT") == 200
        if while_it_computes:
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=GUARD)
            headers = {name: value.replace("PORT", str(port)) for name, value in OWN.items()}
            connection.request("POST", "/front", b"{}", headers)
            connection.getresponse().readline()  # of its progress
        process.send_signal(signal.SIGINT)
        assert (*process.communicate(timeout=GUARD), process.returncode) == ("", "", 0)
    finally:
        process.kill()
        process.communicate()
