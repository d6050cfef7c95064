"""Fixtures that the tests of the command line share: a folder of their own and refusals."""

import pytest


@pytest.fixture(autouse=True)
def _as_typed(folder, monkeypatch, quick_pictures):
    """Standing in a folder of the test's own, with lines of 100 letters."""
    monkeypatch.setenv("COLUMNS", "100")


def contents(folder):
    """All files of a folder with what they hold, and the folders in it."""
    return {path: path.is_file() and path.read_bytes() for path in folder.rglob("*")}


@pytest.fixture
def refused(call, folder):
    """Run a line that must fail in one line, and leave the folder as it was; that line."""

    def run_refused(line, status=2):
        before = contents(folder)
        code, out, err = call(line)
        assert out == ""
        assert "Traceback" not in err
        assert err.startswith("quietarm: ")
        assert err.count("\n") == 1
        assert err.endswith("\n")
        assert code == status
        assert contents(folder) == before
        return err

    return run_refused
