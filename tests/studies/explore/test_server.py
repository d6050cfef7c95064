"""Whom the page's server answers: this machine by its own names, and not too much at once."""

import http.client
import re
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest

GUARD = 240
"""Seconds after which what does not come has hung, on any machine."""
SOCKET = {
    "Upgrade": "websocket",
    "Connection": "Upgrade",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
}


@pytest.fixture(scope="module")
def port():
    """Of a server that runs until Ctrl-C, which is its only end, and says nothing more."""
    line = [sys.executable, "-m", "quietarm", "explore", "--no-browser"]
    process = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        port = int(re.search(r":(\d+)/", process.stdout.readline())[1])
        # read here: communicate loses what readline has read ahead
        assert process.stdout.readline() == "Ctrl-C ends it\n"
        yield port
        process.send_signal(signal.SIGINT)
        assert (*process.communicate(timeout=GUARD), process.returncode) == ("", "", 0)
    finally:
        process.kill()
        process.communicate()


def status(port, path, headers):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=GUARD)
    connection.putrequest("GET", path, skip_host=True)
    for name, value in headers.items():
        connection.putheader(name, value.replace("PORT", str(port)))
    connection.endheaders()
    answer = connection.getresponse().status
    connection.close()
    return answer


@pytest.mark.slow
@pytest.mark.parametrize("host", ["localhost:PORT", "127.0.0.1:PORT", "[::1]:PORT", "LocalHost"])
def test_it_answers_to_this_machines_names(port, host):
    assert status(port, "/static/js/bokeh.min.js", {"Host": host}) == 200
    own = {"Host": host, "Origin": f"http://{host}", **SOCKET}
    assert status(port, "/ws", own) != 403


@pytest.mark.slow
@pytest.mark.parametrize(
    "host",
    ["evil.example:PORT", "localhost.evil.example", "evil.localhost", "127.0.0.1.evil.example",
     "localhost.", "0.0.0.0:PORT", "127.1:PORT"],
)  # fmt: skip
def test_it_refuses_a_name_that_was_led_here(port, host):
    for path in ("/", "/autoload.js", "/metadata", "/static/js/bokeh.min.js", "/none"):
        assert status(port, path, {"Host": host}) == 403
    for origin in (host, "localhost:PORT"):
        assert status(port, "/ws", {"Host": host, "Origin": f"http://{origin}", **SOCKET}) == 403


def test_another_page_of_this_browser_opens_no_socket(port):
    for origin in ("http://evil.example:PORT", "http://localhost:1", "null"):
        assert status(port, "/ws", {"Host": "localhost:PORT", "Origin": origin, **SOCKET}) == 403


@pytest.mark.slow
def test_a_hundred_requests_at_once_do_not_stop_it(port):
    with ThreadPoolExecutor(100) as visitors:
        hosts = [{"Host": "localhost"}] * 100
        answers = [*visitors.map(lambda headers: status(port, "/", headers), hosts)]
    assert set(answers) == {200, 503}  # some have a page, the others are told to wait
    assert status(port, "/static/js/bokeh.min.js", {"Host": "localhost"}) == 200
