"""Files: found to be writable before the work, written whole or not at all."""

import os
import stat
import subprocess
import sys

import pytest

from quietarm.ocp.files import check_writable, write_whole


def _left_over(folder):
    return sorted(entry.name for entry in folder.iterdir())


@pytest.mark.parametrize("write", [check_writable, lambda path: write_whole(path, "text")])
@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("missing/file", r"folder .*/missing does not exist"),
        (".", "is a folder; give the name of a file"),
        ("pipe", r"/pipe is no ordinary file; give the name of one"),
    ],
)
def test_where_no_file_can_be_is_named(tmp_path, write, name, message):
    (tmp_path / "file").write_text("text")
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(ValueError, match=message):
        write(tmp_path / name)
    assert (tmp_path / "file").read_text() == "text"
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)


def test_a_disk_that_is_full_leaves_the_old_file_and_nothing_else(tmp_path):
    # A file may have no more than a kilobyte: for the process as a disk that is full.
    (tmp_path / "file").write_text("old")
    script = (
        "import resource, signal\n"
        "from quietarm.ocp.files import write_whole\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (1024, 1024))\n"
        "write_whole('file', 'a' * 100_000)\n"
    )
    ran = subprocess.run(
        [sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    last = ran.stderr.strip().splitlines()[-1]
    assert last.endswith("/file cannot be written: file too large; choose another place")
    assert (tmp_path / "file").read_text() == "old"
    assert _left_over(tmp_path) == ["file"]
