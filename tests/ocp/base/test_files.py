"""Files: found to be writable before the work, written whole or not at all."""

import os
import stat
import threading

import pytest
from quietarm.ocp.base.files import check_writable, read_whole, write_whole


def _left_over(folder):
    return sorted(entry.name for entry in folder.iterdir())


# -- what can be written --


@pytest.mark.parametrize("content", ["", "text\n", "Grüße, 30°\n", b"\x00\xff"])
def test_content_is_written_as_it_is(tmp_path, content):
    write_whole(tmp_path / "file", content)
    expected = content if isinstance(content, bytes) else content.encode("utf-8")
    assert (tmp_path / "file").read_bytes() == expected
    assert _left_over(tmp_path) == ["file"]


def test_an_older_file_is_replaced(tmp_path):
    (tmp_path / "file").write_text("a longer text of another time")
    write_whole(tmp_path / "file", "new")
    assert (tmp_path / "file").read_text() == "new"


def test_a_path_may_be_a_string(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_whole("here.txt", "text")
    assert (tmp_path / "here.txt").read_text() == "text"


def test_a_new_file_has_the_permissions_that_the_user_asked_for(tmp_path):
    before = os.umask(0o027)
    try:
        write_whole(tmp_path / "file", "text")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "file").stat().st_mode) == 0o640


def test_a_file_that_is_replaced_keeps_its_permissions(tmp_path):
    (tmp_path / "file").write_text("private")
    (tmp_path / "file").chmod(0o600)
    write_whole(tmp_path / "file", "text")
    assert stat.S_IMODE((tmp_path / "file").stat().st_mode) == 0o600


def test_a_name_as_long_as_the_file_system_allows_is_written(tmp_path):
    write_whole(tmp_path / ("a" * 250), "text")
    assert _left_over(tmp_path) == ["a" * 250]


def test_a_link_still_points_to_the_file_that_was_written(tmp_path):
    (tmp_path / "real.json").write_text("old")
    (tmp_path / "link.json").symlink_to(tmp_path / "real.json")
    write_whole(tmp_path / "link.json", "new")
    assert (tmp_path / "link.json").is_symlink()
    assert (tmp_path / "real.json").read_text() == "new"


# -- what cannot --


@pytest.mark.parametrize("write", [check_writable, lambda path: write_whole(path, "text")])
class TestRefused:
    def test_a_missing_folder_is_named(self, tmp_path, write):
        with pytest.raises(ValueError, match=r"folder .*/missing does not exist"):
            write(tmp_path / "missing" / "file")

    def test_a_file_in_place_of_the_folder_is_named(self, tmp_path, write):
        (tmp_path / "file").write_text("text")
        with pytest.raises(ValueError, match=r"/file"):
            write(tmp_path / "file" / "other")
        assert (tmp_path / "file").read_text() == "text"

    def test_a_folder_is_not_a_file(self, tmp_path, write):
        with pytest.raises(ValueError, match="is a folder; give the name of a file"):
            write(tmp_path)

    def test_an_empty_name_is_not_a_file(self, write):
        with pytest.raises(ValueError, match="the name of the file is empty; give one"):
            write("")

    def test_a_name_too_long_is_refused(self, tmp_path, write):
        with pytest.raises(ValueError, match=r"aaaa.*; choose another place"):  # 255 at most
            write(tmp_path / ("a" * 300))

    def test_a_pipe_or_device_is_named_and_stays(self, tmp_path, write):
        # As /dev/stdout and /dev/null are; to root, replacing the latter breaks the machine.
        pipe = tmp_path / "pipe"
        os.mkfifo(pipe)
        with pytest.raises(ValueError, match=r"/pipe is no ordinary file; give the name of one"):
            write(pipe)
        assert stat.S_ISFIFO(pipe.stat().st_mode)

    @pytest.mark.skipif(os.geteuid() == 0, reason="root writes everywhere")
    def test_a_folder_without_permission_is_named(self, tmp_path, write):
        tmp_path.chmod(0o500)
        try:
            with pytest.raises(ValueError, match="cannot be written"):
                write(tmp_path / "file")
        finally:
            tmp_path.chmod(0o700)


def test_a_folder_that_may_not_be_written_is_found_before_the_work(tmp_path, monkeypatch):
    # For root too, whom permissions do not stop.
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    with pytest.raises(ValueError, match=r"/file cannot be written"):
        check_writable(tmp_path / "file")


def test_checking_makes_nothing(tmp_path):
    assert check_writable(tmp_path / "file") == tmp_path / "file"
    assert check_writable(str(tmp_path / "file")) == tmp_path / "file"
    assert _left_over(tmp_path) == []


# -- whole or not at all --


@pytest.mark.parametrize("failing", ["replace", "fsync"])
@pytest.mark.parametrize(
    ("reason", "raised"),
    [(OSError("disk full"), ValueError), (KeyboardInterrupt(), KeyboardInterrupt)],
)
def test_a_write_that_fails_leaves_the_old_file_and_nothing_else(
    tmp_path, monkeypatch, failing, reason, raised
):
    def fail(*arguments):
        raise reason

    (tmp_path / "file").write_text("old")
    monkeypatch.setattr(os, failing, fail)
    with pytest.raises(raised):
        write_whole(tmp_path / "file", "new")
    assert (tmp_path / "file").read_text() == "old"
    assert _left_over(tmp_path) == ["file"]


def test_a_disk_that_is_full_is_a_value_error(tmp_path, monkeypatch):
    # 'ValueError: When the file cannot be written.'
    def fail(*arguments):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(ValueError, match="file"):
        write_whole(tmp_path / "file", "new")


def test_a_reader_never_sees_half_a_file(tmp_path):
    path, seen, done = tmp_path / "file", set(), threading.Event()
    contents = {letter * 200_000 for letter in "ab"}
    write_whole(path, "a" * 200_000)

    def read():
        last = False
        while not last:
            last = done.is_set()  # it reads once more, so that it has read
            seen.add(path.read_text())

    reader = threading.Thread(target=read)
    reader.start()
    try:
        for _ in range(10):
            for content in contents:
                write_whole(path, content)
    finally:
        done.set()
        reader.join()
    assert seen
    assert seen <= contents


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("a\0b", r"the name 'a\\x00b' has a null character; give another"),
        ("", "the name of the file is empty; give one"),
        (None, "the name of the file is None; give a text or a Path"),
    ],
)
@pytest.mark.parametrize("use", [read_whole, lambda path: write_whole(path, "")])
def test_a_name_that_no_system_takes_is_refused(use, path, words):
    with pytest.raises(ValueError, match=words):
        use(path)
