"""Files and folders that cannot be written are found before the solve."""

import os
from pathlib import Path

import pytest
from lines import EVERY_FILE, MOVE, PLAN, TWO_TERMS


@pytest.mark.parametrize("command", [PLAN, f"evaluate {MOVE} {TWO_TERMS}"])
@pytest.mark.parametrize(
    ("option", "value", "remedy"),
    [
        ("--output", "nowhere/plan.json", "folder nowhere does not exist; make it first"),
        ("--csv", "nowhere/move.csv", "folder nowhere does not exist; make it first"),
        ("--figure", "nowhere/move.png", "folder nowhere does not exist; make it first"),
        ("--output", "old.txt/plan.json", "cannot be written: not a directory"),
        ("--output", ".", "is a folder; give the name of a file in it"),
        ("--csv", "kept", "kept is a folder; give the name of a file in it"),
        ("--figure", "kept", "kept is a folder; give the name of a file in it"),
        ("--figure", "move.jpg", "move.jpg is no picture; end its name in .png, .pdf, .svg"),
        ("--output", "/proc/plan.json", "/proc/plan.json cannot be written: "),
        ("--output", "link", "folder /nowhere does not exist; make it first"),
        ("--figure", "move", "move is no picture; end its name in .png, .pdf, .svg"),
    ],
)
def test_an_output_that_cannot_be_is_found_before_the_solve(
    refused, no_solve, folder, command, option, value, remedy
):
    (folder / "kept").mkdir()
    (folder / "old.txt").write_text("old")
    (folder / "link").symlink_to("/nowhere/plan.json")
    message = refused(f"{command} {option} {value}", status=2)
    assert option in message
    assert remedy in message


@pytest.fixture
def read_only(folder, monkeypatch):
    """A folder that may not be written to."""
    locked = folder / "locked"
    locked.mkdir()
    locked.chmod(0o555)
    if os.access(locked, os.W_OK):  # root may write anywhere: answer as for anyone else
        answer = os.access
        monkeypatch.setattr(
            os, "access", lambda path, mode: Path(path).resolve() != locked and answer(path, mode)
        )
    yield locked
    locked.chmod(0o755)


@pytest.mark.parametrize(
    "line",
    [
        f"{PLAN} --output locked/plan.json",
        f"{PLAN} --csv locked/move.csv",
        f"{PLAN} --figure locked/move.png",
        "reproduce --output locked",
        "reproduce --output locked/results",
        f"front {MOVE} --method vepso --bound 0.2 --output locked/front.json",
        f"front {MOVE} --method vepso --bound 0.2 --checkpoint locked/state",
        f"front {MOVE} --method vepso --bound 0.2 --figure locked/front.png",
    ],
)
def test_a_folder_that_cannot_be_written_to_is_found_before_the_solve(
    refused, no_solve, read_only, line
):
    message = refused(line, status=2)
    assert "locked" in message
    assert "cannot be written; choose another place" in message


@pytest.mark.parametrize(
    ("rate", "value"),
    [("0", "0 Hz"), ("-5", "-5 Hz"), ("nan", "nan"), ("inf", "inf"), ("1e12", "1e+12 Hz")],
)
@pytest.mark.parametrize("command", [PLAN, f"evaluate {MOVE} {TWO_TERMS}"])
def test_a_sample_rate_that_cannot_be_is_found_before_the_solve(
    refused, no_solve, command, rate, value
):
    message = refused(f"{command} {EVERY_FILE} --sample-rate {rate}", status=2)
    assert value in message


@pytest.mark.parametrize(
    ("value", "remedy"),
    [
        ("nowhere/results", "folder nowhere does not exist; make it first"),
        ("old.txt", "old.txt is a file; give a folder"),
    ],
)
def test_a_reproduction_finds_a_bad_folder_before_its_solves(
    refused, no_solve, folder, value, remedy
):
    (folder / "old.txt").write_text("old")
    assert remedy in refused(f"reproduce --output {value}", status=2)


@pytest.mark.parametrize("line", ["polish", f"front {MOVE} --method vepso --bound 0.2 --resume"])
def test_a_link_that_goes_in_a_circle_is_told(refused, folder, line):
    (folder / "round").symlink_to("round")
    assert "round cannot be read: too many levels of symbolic links" in refused(f"{line} round")


def test_the_page_of_a_study_and_its_fronts_are_in_two_places(refused):
    told = refused(f"study {MOVE} --output study.html --fronts ./study.html")
    assert "--output and --fronts are both study.html" in told
