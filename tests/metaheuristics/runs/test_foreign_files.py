"""What is not a whole checkpoint is refused, and nothing in it is run."""

import io
import json
import os
import pickle
import struct
import warnings
import zipfile
import zlib

import numpy as np
import pytest
from quietarm.metaheuristics.runs.checkpoint import KIND, VERSION, load_checkpoint
from quietarm.ocp import FileFormatError
from states import HEADER, same, state

FORMAT = f"quietarm-{KIND}"


def refused(path, message="is not a checkpoint, or not a whole one"):
    """Refused in one line that names the file, which stays as it was."""
    before = (path.read_bytes(), path.stat().st_mtime_ns) if path.is_file() else None
    with pytest.raises(FileFormatError, match=message) as caught:
        load_checkpoint(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert before == ((path.read_bytes(), path.stat().st_mtime_ns) if path.is_file() else None)


@pytest.mark.parametrize("share", [0.0, 0.001, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.999])
def test_a_truncated_file_is_refused(path, good, share):
    path.write_bytes(good[: int(share * len(good))])
    refused(path, "not a checkpoint, or not a whole one")


def test_a_file_without_its_last_byte_is_refused(path, good):
    path.write_bytes(good[:-1])
    refused(path, "not a checkpoint, or not a whole one")


def test_a_file_without_its_first_bytes_is_refused(path, good):
    path.write_bytes(good[100:])
    refused(path)


def test_a_refused_file_is_not_left_open(path, good):
    path.write_bytes(good[: len(good) // 2])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)
        before = len(os.listdir("/proc/self/fd"))
        errors = []
        for _ in range(5):
            try:
                load_checkpoint(path)
            except FileFormatError as error:
                errors.append(error.with_traceback(None))
        assert len(errors) == 5
        assert len(os.listdir("/proc/self/fd")) == before


def test_damage_within_an_array_is_noticed(path, good):
    at = good.index(state()["algorithm"]["population"]["X"].tobytes()) + 11
    path.write_bytes(good[:at] + bytes([good[at] ^ 1]) + good[at + 1 :])
    refused(path)


@pytest.mark.parametrize("seed", range(3))
def test_damage_anywhere_is_refused_or_harmless(path, good, seed):
    """Never another state, and never another error: over one bit in 40 bytes."""
    rng = np.random.default_rng(seed)
    wrong = []
    for at in rng.choice(len(good), len(good) // 40, replace=False).tolist():
        changed = good[at] ^ (1 << int(rng.integers(8)))
        path.write_bytes(good[:at] + bytes([changed]) + good[at + 1 :])
        try:
            header, found = load_checkpoint(path)
        except FileFormatError:
            continue
        except Exception as error:
            wrong.append((at, repr(error)))
        else:
            if not (header == HEADER and same(found, state())):
                wrong.append((at, "another state"))
    assert wrong == []


def _npz(**named):
    content = io.BytesIO()
    np.savez(content, **named)
    return content.getvalue()


def _npy(array):
    content = io.BytesIO()
    np.save(content, array)
    return content.getvalue()


def _zip(**named):
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as file:
        for name, data in named.items():
            file.writestr(name.replace("_npy", ".npy"), data)
    return content.getvalue()


def _with_header(document, **named):
    text = document if isinstance(document, bytes) else json.dumps(document).encode()
    return _npz(header=np.frombuffer(text, dtype=np.uint8), **named)


def _whole(**changes):
    return {"format": FORMAT, "version": VERSION, **HEADER, "state": {}, **changes}


def _bad_deflate():
    content = io.BytesIO()
    np.savez_compressed(content, header=np.zeros(1000, dtype=np.uint8))
    data = bytearray(content.getvalue())
    data[80:90] = b"\xff" * 10
    return bytes(data)


def _locked():
    """A checkpoint in a zip with a password: the flag in the directory at the end says so."""
    data = bytearray(_with_header(_whole()))
    data[data.index(b"PK\x01\x02") + 8] |= 1
    return bytes(data)


def _huge():
    """An array that claims a petabyte."""
    text = "{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000000,), }"
    text = text.ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text.encode()


FOREIGN = {
    "empty": b"",
    "text": b"a letter\nof two lines\n",
    "JSON": json.dumps(_whole()).encode(),
    "PNG": b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + b"IHDR" + bytes(200),
    "zeros": bytes(1000),
    "gzip": b"\x1f\x8b\x08\x00" + zlib.compress(b"text"),
    "pickle": pickle.dumps({"format": FORMAT}),
    "npy": _npy(np.arange(3.0)),
    "cut npy": _npy(np.arange(3.0))[:20],
    "npz of something else": _npz(X=np.arange(3.0)),
    "empty npz": _zip(),
    "zip of texts": _zip(header=b"hello", other=b"text"),
    "text in place of an array": _zip(header_npy=b"hello"),
    "header of floats": _npz(header=np.zeros((2, 2))),
    "header of no JSON": _with_header(b"{'a': 1}"),
    "header of no UTF-8": _with_header(b"\xff\xfe\xfa"),
    "header of a list": _with_header([1, 2]),
    "header of a number": _with_header(3),
    "header very deep": _with_header(b"[" * 100_000),
    "no state": _with_header({"format": FORMAT, "version": VERSION}),
    "no format": _with_header({"version": VERSION, "state": {}}),
    "no version": _with_header({"format": FORMAT, "state": {}}),
    "state of a list": _with_header(_whole(state=[1])),
    "state of nothing": _with_header(_whole(state=None)),
    "version of a text": _with_header(_whole(version="1")),
    "version of nothing": _with_header(_whole(version=None)),
    "version zero": _with_header(_whole(version=0)),
    "another format": _with_header(_whole(format="quietarm-plan")),
    "damaged compression": _bad_deflate(),
    "a zip with a password": _locked(),
    "an array of a petabyte": _zip(header_npy=_huge()),
}


def test_another_format_is_named(path):
    path.write_bytes(_with_header(_whole(format="somebody's-own")))
    refused(path, "somebody's-own")


@pytest.mark.parametrize("lost", ["state.history.npy", "state.algorithm.population.X.npy"])
def test_a_file_that_lost_an_array_is_refused(path, good, lost):
    with zipfile.ZipFile(io.BytesIO(good)) as old, zipfile.ZipFile(path, "w") as new:
        assert lost in old.namelist()
        for name in old.namelist():
            if name != lost:
                new.writestr(name, old.read(name))
    refused(path)


def test_a_missing_file_is_named(path):
    refused(path, "no such file")


def test_a_folder_is_refused(path):
    path.mkdir()
    refused(path, "is a directory")


@pytest.mark.skipif(os.geteuid() == 0, reason="root reads everything")
def test_a_file_without_permission_is_refused(path, good):
    path.chmod(0)
    with pytest.raises(FileFormatError, match="permission denied"):
        load_checkpoint(path)


# -- nothing runs --


class Runs:
    """Makes a file when it is unpickled."""

    def __init__(self, path):
        self.path = str(path)

    def __reduce__(self):
        return open, (self.path, "w")


@pytest.mark.parametrize("name", ["header", "X", "algorithm.population.X"])
def test_a_pickle_inside_is_refused_and_not_run(path, tmp_path, name):
    ran = tmp_path / "ran"
    named = {name: np.array([Runs(ran)], dtype=object)}
    path.write_bytes(_npz(**named) if name == "header" else _with_header(_whole(), **named))
    with warnings.catch_warnings():  # the file that it opens, to see that the trap works
        warnings.simplefilter("ignore", ResourceWarning)
        np.load(path, allow_pickle=True)[name]
    assert ran.exists()
    ran.unlink()
    refused(path, "not a checkpoint")
    assert not ran.exists()


def test_a_pickle_in_place_of_the_file_is_refused_and_not_run(path, tmp_path):
    path.write_bytes(pickle.dumps(Runs(tmp_path / "ran")))
    refused(path, "not a checkpoint")
    assert not (tmp_path / "ran").exists()
