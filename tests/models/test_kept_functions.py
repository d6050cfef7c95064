"""Functions left by a process are used if, and only if, this user's process wrote them."""

import json
import os
import stat
import subprocess
import sys
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np
import pytest
from small_robots import ARM, ARM_FILE, write_robot

from quietarm.models import kept_functions
from quietarm.models.kept_functions import kept_arrays, kept_function

PARTS = ("what", 1, 2.5, np.arange(3.0), (None, {"a": True}))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The user's folder, empty, where everything is kept however quickly it was built."""
    monkeypatch.setenv("QUIETARM_CACHE", str(tmp_path))
    monkeypatch.setattr(kept_functions, "LEAST_SECONDS", -1.0)
    return tmp_path / "functions"


class Builder:
    """A function, and how often it was built."""

    def __init__(self):
        self.count = 0

    def __call__(self):
        self.count += 1
        x = ca.SX.sym("x")
        return ca.Function("square", [x], [ca.sin(x) * x])


def built(parts=PARTS):
    """Count how often a function is built if a process wants it, which computes what it should."""
    build = Builder()
    function = kept_function(parts, build)
    assert float(function(1.5)) == float(Builder()()(1.5))
    return build.count


def kept(folder):
    """The file of the one function that is kept."""
    (path,) = (path for path in folder.iterdir() if path.name != "key")
    return path


def test_the_next_process_does_not_build(folder):
    assert [built(), built()] == [1, 0]


@pytest.mark.parametrize(
    "other",
    [
        ("what", 1, 2.5, np.arange(3.0), (None, {"a": False})),
        ("what", 1, 2.5000000000000004, np.arange(3.0), (None, {"a": True})),
        ("what", 1, 2.5, np.arange(3), (None, {"a": True})),
        ("what", "1", 2.5, np.arange(3.0), (None, {"a": True})),
        ("wha", "t", 1, 2.5, np.arange(3.0), (None, {"a": True})),
    ],
)
def test_other_parts_are_another_function(folder, other):
    assert built() == 1
    assert built(other) == 1


def test_what_does_not_say_all_that_it_is_is_never_kept(folder):
    @dataclass(frozen=True)
    class Own:
        value: float = 1.0

    for part in (Own(), lambda: 1.0, ca.SX.sym("x"), object()):
        assert [built((part,)), built((part,))] == [1, 1]


def change(path, at):
    """Turn one bit of a file."""
    content = bytearray(path.read_bytes())
    content[at] ^= 1
    path.write_bytes(content)


SPOILT = {
    "a bit of its head": lambda path: change(path, 0),
    "a bit of its digest": lambda path: change(path, 20),
    "its last bit": lambda path: change(path, -1),
    "cut": lambda path: path.write_bytes(path.read_bytes()[:-7]),
    "empty": lambda path: path.write_bytes(b""),
    "a text without digest": lambda path: path.write_text(Builder()().serialize()),
    "others may read it": lambda path: path.chmod(0o644),
    "others may write it": lambda path: path.chmod(0o620),
}


@pytest.mark.skipif(os.name == "nt", reason="modes of files are those of POSIX")
@pytest.mark.parametrize("spoil", SPOILT.values(), ids=SPOILT)
def test_a_file_that_is_not_as_it_was_written_is_not_used(folder, spoil):
    assert built() == 1
    spoil(kept(folder))
    assert built() == 1
    assert built() == 0  # it was written anew


def test_a_file_by_another_name_is_not_used(folder):
    assert built() == 1
    path = kept(folder)
    whole = path.read_bytes()
    path.unlink()
    assert built(("another",)) == 1
    kept(folder).write_bytes(whole)
    assert built(("another",)) == 1


def test_a_link_is_not_followed(folder, tmp_path):
    assert built() == 1
    path = kept(folder)
    path.rename(tmp_path / "elsewhere")
    path.symlink_to(tmp_path / "elsewhere")
    assert built() == 1


def test_files_of_another_key_are_not_used(folder):
    assert built() == 1
    (folder / "key").write_bytes(b"short")
    kept_functions.forget_folders()
    assert [built(), built()] == [1, 0]


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="users of POSIX")
def test_what_another_user_owns_is_not_used(folder, monkeypatch):
    assert built() == 1
    monkeypatch.setattr(os, "geteuid", lambda: 12345)
    assert built() == 1  # the file
    kept_functions.forget_folders()
    assert [built(), built()] == [1, 1]  # the folder


@pytest.mark.skipif(os.name == "nt", reason="modes of files are those of POSIX")
def test_a_folder_that_others_may_enter_is_not_used(folder):
    assert built() == 1
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    assert {stat.S_IMODE(path.stat().st_mode) for path in folder.iterdir()} == {0o600}
    folder.chmod(0o755)
    kept_functions.forget_folders()
    assert [built(), built()] == [1, 1]


def test_what_another_version_left_is_not_used(folder, monkeypatch):
    assert built() == 1
    monkeypatch.setattr(kept_functions, "origin", lambda: "another version")
    assert [built(), built()] == [1, 0]


def test_sources_that_were_edited_since_they_were_read_keep_nothing_for_others(folder, monkeypatch):
    assert built() == 1
    monkeypatch.setattr(kept_functions, "LOADED", 0)
    for _ in range(2):
        process = cache(kept_functions.origin.__wrapped__)
        monkeypatch.setattr(kept_functions, "origin", process)
        assert [built(), built()] == [1, 0]


def test_what_casadi_does_not_read_is_built(folder):
    kept_functions.folder_of_user().write(kept_functions.name_of(PARTS), b"no function")
    assert [built(), built()] == [1, 0]


def test_a_folder_by_a_relative_name_is_one(folder, monkeypatch, tmp_path):
    monkeypatch.setenv("QUIETARM_CACHE", "beside")
    (tmp_path / "another").mkdir()
    monkeypatch.chdir(tmp_path)
    assert built() == 1
    monkeypatch.chdir(tmp_path / "another")
    assert built() == 0


@pytest.mark.parametrize("name", ["off", ""])
def test_nothing_is_kept_if_it_is_switched_off(monkeypatch, tmp_path, name):
    monkeypatch.setenv("QUIETARM_CACHE", name)
    monkeypatch.chdir(tmp_path)
    assert [built(), built()] == [1, 1]
    assert not list(tmp_path.iterdir())


def test_a_folder_that_cannot_be_made_is_done_without(monkeypatch, tmp_path):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("QUIETARM_CACHE", str(tmp_path / "file"))
    assert [built(), built()] == [1, 1]


def test_a_full_disk_is_done_without(folder, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    assert built(("before",)) == 1
    monkeypatch.setattr(os, "replace", full)
    assert [built(), built()] == [1, 1]
    assert len(list(folder.iterdir())) == 2  # the key, and what was there; nothing unfinished


def test_what_was_not_used_for_longest_makes_room(folder, monkeypatch):
    for number in range(4):
        assert built((number,)) == 1
        os.utime(max(folder.iterdir(), key=os.path.getmtime), (number, number))
    whole = sum(path.stat().st_size for path in folder.iterdir())
    monkeypatch.setattr(kept_functions, "MOST_BYTES", whole)
    assert built((4,)) == 1
    assert [built((0,)), built((3,)), built((4,))] == [1, 0, 0]


def test_arrays_come_back_as_they_were(folder):
    arrays = {
        "one": np.array([0.1, -0.0, np.pi]),
        "modes K": np.zeros((2, 0, 3)),
        "n": np.arange(3),
    }
    first = kept_arrays(("arrays",), lambda: arrays)
    again = kept_arrays(("arrays",), dict)
    assert first.keys() == again.keys() == arrays.keys()
    for name, array in arrays.items():
        assert again[name].tobytes() == array.tobytes()
        assert (again[name].dtype, again[name].shape) == (array.dtype, array.shape)


def test_two_processes_at_once(folder):
    """Each has what it asked for, whoever writes; the key is one."""
    work = (
        "from quietarm.models.kept_functions import kept_arrays\n"
        "import numpy as np\n"
        "for number in range(150):\n"
        "    name = number % 5\n"
        "    made = kept_arrays((name,), lambda: {'a': np.full(2000, float(name))})\n"
        "    assert (made['a'] == name).all() and made['a'].shape == (2000,)\n"
    )
    runs = [subprocess.Popen([sys.executable, "-c", work]) for _ in range(2)]
    assert [run.wait() for run in runs] == [0, 0]
    # in a process of its own: this one may have begun before a test touched the sources
    read = (
        "from quietarm.models.kept_functions import kept_arrays\n"
        "assert kept_arrays((3,), dict)['a'][0] == 3.0\n"
    )
    subprocess.run([sys.executable, "-c", read], check=True)
    assert len(list(folder.iterdir())) == 6


@pytest.mark.slow
def test_a_plan_of_kept_functions_is_the_same_to_the_last_digit(tmp_path):
    """A plan, and what another load leaves, without the folder, with it empty, and by it."""
    robot = write_robot(tmp_path, ARM, ARM_FILE)
    move = "--start=0,0.4 --target=0.8,-0.2 --duration=0.9 --terms=4"

    def answer(kept):
        output = tmp_path / "plan.json"
        command = [sys.executable, "-m", "quietarm", "plan", str(robot), *move.split()]
        environment = {**os.environ, "QUIETARM_CACHE": str(kept)}
        run = subprocess.run([*command, f"--output={output}"], env=environment, text=True,
                             stdout=subprocess.PIPE, check=True)  # fmt: skip
        plan = json.loads(output.read_text())
        rows = [line for line in run.stdout.splitlines() if not line.startswith("time ")]
        return rows, {name: plan[name] for name in plan if name not in ("record", "checksum")}

    def files():
        return {path.name: path.stat().st_ino for path in (tmp_path / "functions").iterdir()}

    without = answer("off")
    assert answer(tmp_path) == without
    before = files()
    assert len(before) > 5
    assert answer(tmp_path) == without
    # what took just less than the least time may be slower in the second run, and be kept by it
    assert before.items() <= files().items()
