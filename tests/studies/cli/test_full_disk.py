"""A disk that is full: the file is named, and of files that need each other none is left alone."""

import errno
import os
from pathlib import Path

import pytest
from lines import MOVE

from quietarm.ocp import files


def no_space(*_, **_settings):
    """Fail as a system does on a full disk: it says not which file it was."""
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.fixture
def full_after(monkeypatch):
    """Let so many files find room, and none after them."""

    def fill(count):
        room = iter(range(count))
        sync = os.fsync

        def write_through(number):
            return sync(number) if next(room, None) is not None else no_space()

        monkeypatch.setattr(files.os, "fsync", write_through)

    return fill


@pytest.fixture
def saved(done, folder):
    """A saved plan."""
    done(f"evaluate {MOVE} --coefficients=0 --output move.json")
    return folder


LINES = {
    "export move.json --output a.csv": "a.csv",
    "export move.json --output a.c": "a.h",
    "export move.json --output a.yaml --rate 50": "a.yaml",
    f"evaluate {MOVE} --coefficients=0 --output a.json": "a.json",
    f"evaluate {MOVE} --coefficients=0 --output a.csv": "a.csv",
    "list problems --output a": "a/single-link-30deg-0.8s.json",
}


@pytest.mark.slow
def test_the_file_is_named_and_nothing_is_left(call, saved, full_after):
    full_after(0)
    before = sorted(saved.iterdir())
    for line, name in LINES.items():
        status, _, err = call(line)
        assert status == 2, line
        assert f"{name} cannot be written: no space left on device; choose another place" in err
        assert "standard output" not in err
        assert sorted(saved.iterdir()) == before, line


def test_a_dataset_is_named(call, folder, monkeypatch):
    import zarr

    monkeypatch.setattr(zarr, "create_group", no_space)
    status, _, err = call(
        "sweep single-link --target 20deg,30deg --duration 0.8,0.9 --output a.zarr"
    )
    assert status == 2
    assert "a.zarr cannot be written: no space left on device" in err
    assert not list(folder.iterdir())


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("room", [0, 1])
def test_header_and_source_are_both_there_or_neither(call, saved, full_after, room):
    full_after(room)
    status, _, err = call("export move.json --output move.c")
    assert status == 2
    assert f"move.{'ch'[room == 0]} cannot be written: no space left on device" in err
    assert [path.name for path in saved.iterdir()] == ["move.json"]


def test_those_that_were_there_stay_where_one_cannot_be_replaced(tmp_path, monkeypatch):
    header, source = tmp_path / "move.h", tmp_path / "move.c"
    for path in (header, source):
        path.write_text("before")
    replace = os.replace

    def replaced(begin, end):
        return no_space() if Path(end) == source else replace(begin, end)

    monkeypatch.setattr(files.os, "replace", replaced)
    with pytest.raises(ValueError, match=r"move\.c cannot be written: no space left"):
        files.write_together({header: "after", source: "after"})
    assert (header.read_text(), source.read_text()) == ("before", "before")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["move.c", "move.h"]
    source.unlink()
    header.unlink()
    with pytest.raises(ValueError, match=r"move\.c cannot be written"):
        files.write_together({header: "after", source: "after"})
    assert not list(tmp_path.iterdir())


def test_both_are_replaced_and_keep_their_permissions(tmp_path):
    header, source = tmp_path / "move.h", tmp_path / "move.c"
    header.write_text("before")
    header.chmod(0o600)
    files.write_together({header: "one", source: b"two"})
    assert (header.read_text(), source.read_text()) == ("one", "two")
    assert header.stat().st_mode & 0o777 == 0o600
