"""Closed streams, and outputs that lead round: a line at most, and no traceback."""

import os
import signal
import subprocess
import time

import pytest
from lines import MOVE, QUIETARM, TWO_TERMS


def run(line, closed):
    """The command of a shell that has closed some streams."""
    return subprocess.run(
        ["sh", "-c", f"exec {QUIETARM} {line} {closed}"],
        capture_output=True, text=True, timeout=120,
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("closed", [">&-", ">&- 2>&-", "<&- >&- 2>&-"])
def test_a_file_is_written_whatever_is_closed(folder, plan, closed):
    plan.save("plan.json")
    done = run("export plan.json --output move.csv", closed)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert (folder / "move.csv").read_text().startswith("time_s,")


@pytest.mark.slow
@pytest.mark.parametrize(
    "line",
    [
        "--version", "--help", "export --help", "compare plan.json --output compared",
        f"plan {MOVE} --terms 2 --output again.json",
        f"front {MOVE} --terms 2 --points 3 --quiet --output front.csv",
        f"sweep {MOVE.replace('30deg', '30deg,40deg')} --terms 2 --quiet --output few.zarr",
    ],
)  # fmt: skip
def test_words_go_nowhere_where_standard_output_is_closed(folder, plan, line):
    plan.save("plan.json")
    done = run(line, ">&-")
    assert (done.returncode, done.stderr) == (0, "")


ONE_MOVE = f"{MOVE} --terms 2"


@pytest.mark.slow_after(1)
@pytest.mark.parametrize(
    "line",
    [
        "list", "list nsga2", f"plan {ONE_MOVE}", f"plan {ONE_MOVE} --output -",
        f"plan {ONE_MOVE} --output again.json --output -", f"evaluate {MOVE} {TWO_TERMS}",
        f"front {ONE_MOVE} --output -", f"search {ONE_MOVE} --bound 0.2", "compare plan.json",
        "export plan.json --output -", "export plan.json --output - --format ros",
        "identify plan.json flexible-beam --tip tip",
    ],
)  # fmt: skip
def test_an_answer_that_would_be_lost_is_refused_before_the_work(folder, plan, line):
    plan.save("plan.json")
    done = run(line, ">&-")
    told = "quietarm: standard output is closed; give the name of a file\n"
    assert (done.returncode, done.stderr) == (2, told)
    assert [path.name for path in folder.iterdir()] == ["plan.json"]


@pytest.mark.parametrize(
    "line",
    [
        f"plan {MOVE} --output loop.json", "compare plan.json --output loop",
        "export plan.json --output loop.csv", "reproduce --output loop",
        "bench single-link-30deg-0.8s --output loop",
        "sweep single-link --target 1,2 --duration 1 --output loop.zarr",
    ],
)  # fmt: skip
def test_an_output_that_leads_round_is_refused(call, folder, plan, line):
    plan.save("plan.json")
    for name in ("loop.json", "loop", "loop.csv", "loop.zarr"):
        os.symlink(name, folder / name)
    status, out, err = call(line)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert "cannot be written: too many levels of symbolic links; choose another place" in err


@pytest.mark.slow
@pytest.mark.parametrize("seconds", [1.5, 3.0, 5.0])
def test_a_huge_grid_that_is_ended_says_so_and_leaves_no_temporary_folder(folder, seconds):
    line = "sweep single-link --target 0.001:1:0.001 --duration 1:2:0.001 --yes --output huge.zarr"
    process = subprocess.Popen([QUIETARM, *line.split()], stderr=subprocess.PIPE, text=True)
    time.sleep(seconds)  # whatever it is doing by then
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=120)
    assert process.returncode != 0
    assert "Traceback" not in err
    assert [path.name for path in folder.iterdir() if path.name != "huge.zarr"] == []


def test_a_reader_that_has_read_enough_is_no_error():
    ran = run("list plants", "| head -1")
    assert ran.stdout.startswith("6 plants; ")
    assert ran.stderr == ""


@pytest.mark.parametrize(
    "line",
    [
        f"search {ONE_MOVE} --bound 0.2 --population 8 --generations 2 --output kept.json",
        f"front {ONE_MOVE} --points 3 --output kept.json",
    ],
)
def test_work_goes_on_where_nobody_reads_its_progress(call, folder, monkeypatch, line):
    reader, writer = os.pipe()
    os.close(reader)  # as `2>&1 | head -1` leaves it
    with open(writer, "w", buffering=1) as unread:
        monkeypatch.setattr("sys.stderr", unread)
        status, out, _ = call(line)
    assert status == 0
    assert "wrote kept.json" in out
    assert (folder / "kept.json").exists()
