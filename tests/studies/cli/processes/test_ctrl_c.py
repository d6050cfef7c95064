"""Ctrl-C: what takes long ends, says so, and leaves no half of a file."""

import re
import signal
import subprocess
import sys

import pytest
from lines import MOVE

from quietarm.ocp import Front

INTERRUPTED = "quietarm: interrupted; only files that were written before are kept"
SEARCH = f"search {MOVE} --method vepso --bound 0.2 --terms 2 --population 8 --generations 100000"
FRONT = "front arm-on-flexible-link --target 90deg --duration 0.8 --terms 3 --points 10000"
FILM = "export plan.json --output m.gif --width 2000 --rate 50 --speed 20%"


def skip_where_ignored(number):
    """Nothing hears a signal that is ignored where these tests run, as after nohup."""
    if signal.getsignal(number) is signal.SIG_IGN:
        pytest.skip(f"{number.name} is ignored here")


def begin(process, words):
    """Wait until a process says on standard error that it has begun."""
    while not re.match(words, process.stderr.readline()):
        assert process.poll() is None


@pytest.mark.slow_after(1)
@pytest.mark.parametrize(
    ("line", "words", "number"),
    [
        # the ends of the front are found
        (f"{FRONT} --output f.json --output f.png", r"([2-9]|\d\d+) of ", signal.SIGTERM),
        (FILM, r"\d+ of 501 frames", signal.SIGINT),
    ],
)
def test_what_is_stopped_writes_nothing(at_a_terminal, stop, folder, plan, line, words, number):
    skip_where_ignored(number)
    plan.save("plan.json")
    process = at_a_terminal(line)
    begin(process, words)
    out, err = stop(process, number)
    assert (process.returncode, out) == (128 + number, "")  # as shells have it
    assert err.splitlines()[-1] == INTERRUPTED
    assert [path.name for path in folder.iterdir()] == ["plan.json"]


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_search_that_is_stopped_writes_the_front_until_then(at_a_terminal, stop, folder, number):
    skip_where_ignored(number)
    process = at_a_terminal(f"{SEARCH} --output f.json")
    begin(process, "generation ")
    out, err = stop(process, number)
    assert process.returncode == 128 + number
    assert "wrote f.json" in out
    front = Front.load(folder / "f.json")
    count = front.record.evaluations
    assert 0 < count < 8 * 100_000
    words = f"quietarm: interrupted: the front of the first {count} candidates is written"
    assert err.splitlines()[-1] == words


# Press while a module is being imported: a finder that finds nothing is asked for it first.
PRESSED_AT_IMPORT = """
import signal, sys

class Pressing:
    def find_spec(self, name, path=None, target=None):
        if name == {module!r}:
            signal.raise_signal({number})

sys.meta_path.insert(0, Pressing())
sys.argv[0] = "quietarm"
from quietarm.__main__ import main
main()
"""


@pytest.mark.slow_after(2)
@pytest.mark.parametrize(
    ("line", "module", "number"),
    [
        ("list", "numpy", signal.SIGINT),
        ("list", "click", signal.SIGHUP),
        ("export plan.json --output move.gif", "matplotlib.figure", signal.SIGTERM),
    ],
)
def test_a_signal_during_an_import_is_answered(folder, plan, line, module, number):
    skip_where_ignored(number)
    plan.save("plan.json")
    script = PRESSED_AT_IMPORT.format(module=module, number=int(number))
    ended = subprocess.run(
        [sys.executable, "-c", script, *line.split()], capture_output=True, text=True, timeout=120
    )
    assert ended.stderr.splitlines()[-1:] == [INTERRUPTED]
    assert "Traceback" not in ended.stderr
    assert (ended.returncode, ended.stdout) == (128 + number, "")
    assert [path.name for path in folder.iterdir()] == ["plan.json"]
