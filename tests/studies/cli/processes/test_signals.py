"""Ctrl-C and the end of a batch job: what was found is kept and said, without a traceback."""

import os
import re
import signal

import pytest
from lines import MOVE
from quietarm.ocp import Front

STUDY = (
    f"study {MOVE} --method nsga2 --bound 0.2 --population 8 --generations 2 --terms 2 --points 3"
)
STOPS = [signal.SIGINT, signal.SIGTERM]
GUARD = 240
"""Seconds after which a process that does not end has hung, on any machine."""


@pytest.fixture(autouse=True)
def folder(folder, monkeypatch):
    """A folder of the test's own, and standing in it; lines are not wrapped."""
    monkeypatch.setenv("COLUMNS", "1000")
    return folder


def read_until(process, begin):
    """Read standard error until a line that begins so; all lines until then."""
    lines = []
    for line in process.stderr:
        lines.append(line)
        if line.startswith(begin):
            return lines
    raise AssertionError(f"never said {begin!r}, but {''.join(lines)}")


def stop(process, number):
    """Send a signal to a process and to those that it started; what it says until all ended."""
    os.killpg(process.pid, number)
    return process.communicate(timeout=GUARD)


def test_a_study_keeps_the_pieces_that_were_done(at_a_terminal, folder):
    process = at_a_terminal(f"{STUDY} --runs 2 --workers 2 --fronts fronts")
    read_until(process, "[4/6]")
    out, err = stop(process, signal.SIGINT)
    assert process.returncode == 1
    assert "Traceback" not in err
    (done,) = re.fullmatch(
        r"quietarm: interrupted: (\d) of 6 pieces of work are done; what was found until then is "
        r"kept", err.splitlines()[-1],
    ).groups()  # fmt: skip
    # a piece begins where a worker is free; however late the signal is, it comes before the end
    assert 2 <= int(done) < 6
    written = out.splitlines()[-2:]
    assert written[0] == "wrote study.html"
    fronts = [Front.load(path) for path in (folder / "fronts").iterdir()]
    assert written[1] == f"wrote {len(fronts)} fronts to fronts"
    # every piece gives a front, but for the last, the floor
    assert sum(front.complete for front in fronts) == int(done)
    assert "interrupt" in (folder / "study.html").read_text()


@pytest.mark.parametrize("number", STOPS)
def test_a_search_keeps_what_it_found(at_a_terminal, folder, number):
    if signal.getsignal(number) is signal.SIG_IGN:
        pytest.skip("ignored where these tests run, as after nohup")
    process = at_a_terminal(
        f"front {MOVE} --method nsga2 --bound 0.2 --population 20 --generations 100000 "
        "--output f.json"
    )
    read_until(process, "generation ")
    out, err = stop(process, number)
    assert process.returncode == 1
    assert err.splitlines()[-1] == "quietarm: interrupted; what was found until then is kept"
    assert out.splitlines()[-1] == "wrote f.json"
    found = Front.load("f.json")
    assert not found.complete
    assert found.points


def test_ctrl_c_while_files_are_written_waits_until_they_are_there(call, folder, monkeypatch):
    sync = os.fsync

    def interrupted(handle):
        signal.raise_signal(signal.SIGINT)
        sync(handle)

    monkeypatch.setattr(os, "fsync", interrupted)
    code, out, err = call(f"evaluate {MOVE} --coefficients=0 --output o.json --csv o.csv")
    assert (code, err) == (1, "quietarm: interrupted; wrote o.json, o.csv\n")
    assert out.splitlines()[-2:] == ["wrote o.json", "wrote o.csv"]
    assert sorted(path.name for path in folder.iterdir()) == ["o.csv", "o.json"]
