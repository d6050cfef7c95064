"""A dataset that somebody has changed since it was swept is refused, and not believed."""

import json
import math
import os
import shutil
import subprocess

import numpy as np
import pytest
from lines import COARSELY

import quietarm as qa
from quietarm.ocp import FileFormatError
from quietarm.studies.sweep.definition import JUMP
from quietarm.studies.sweep.library import MoveLibrary
from quietarm.studies.sweep.store import Store

zarr = pytest.importorskip("zarr")


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """Four moves, with what is known of those between them."""
    path = tmp_path_factory.mktemp("swept") / "few.zarr"
    task = qa.PointToPoint(qa.SingleLinkManipulator(), target=math.radians(60), duration=0.8)
    axes = {"target": [math.radians(30), math.radians(60)], "duration": [0.8, 1.2]}
    qa.sweep(task, qa.CycloidPolynomial(2), axes=axes, path=path)
    MoveLibrary(path).between()
    return path


@pytest.fixture
def copied(swept, folder):
    return shutil.copytree(swept, folder / "copy.zarr")


def set_first(path, name, value):
    array = zarr.open_group(path, mode="r+")[name]
    values = array[...]
    values.flat[0] = value(values.flat[0])
    array[...] = values


def set_sweep(path, value, *place):
    group = zarr.open_group(path, mode="r+")
    document = json.loads(group.attrs["sweep"])
    part = document
    for step in place[:-1]:
        part = part[step]
    part[place[-1]] = value
    group.attrs["sweep"] = json.dumps(document)


def half(value):
    return value / 2


def test_what_was_not_changed_is_read(swept):
    store = Store(swept)
    store.check()
    assert store.missing() == []


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("energy", half), ("energy", lambda _: np.nan), ("residual", half), ("peak_torque", half),
        ("coefficients", half), ("cold_excess", lambda _: 1.0), ("status", lambda _: 99),
        ("status", lambda _: -5), ("status", lambda _: 0), ("digest", lambda value: value + 1),
    ],
)  # fmt: skip
def test_a_changed_number_is_told(copied, call, name, value):
    set_first(copied, name, value)
    with pytest.raises(FileFormatError, match="is not what was swept; remove the dataset and sw"):
        Store(copied).check()
    if name in ("coefficients", "status"):
        line = f"plan --from {copied} --target 40deg --duration 0.9"
        status, out, err = call(line)
        assert (status, out, err.count("\n")) == (2, "", 1)


AXES = ("grid", "axes")


@pytest.mark.parametrize(
    ("value", "place"),
    [
        ("speed", (*AXES, 0, "name")), ("duration", (*AXES, 0, "name")), ("m", (*AXES, 0, "unit")),
        ([math.nan, 1.0], (*AXES, 0, "values")), ([], (*AXES, 0, "values")),
        ([0.5, 0.6], (*AXES, 0, "values")), ("all", (*AXES, 0, "values")), ([], AXES),
        ([0.1 * k for k in range(200_000)], (*AXES, 0, "values")),
        (10**9, ("front",)), (-1.0, ("margin",)), (5, ("profile", "terms")),
        (0.5, ("grid", "task", "residual_window")),
    ],
)  # fmt: skip
def test_a_changed_question_is_told(copied, value, place):
    set_sweep(copied, value, *place)
    with pytest.raises(FileFormatError, match="remove the dataset and sweep it again"):
        Store(copied).check()


@pytest.mark.slow_after(2)
@pytest.mark.parametrize("text", ["[]", "5", "no JSON", "[" * 100_000, 7, None])
def test_an_attribute_of_another_kind_is_told_or_found_anew(copied, text):
    known = MoveLibrary(copied).between()
    for name in ("moves between the cells", "sweep"):
        zarr.open_group(copied, mode="r+").attrs[name] = text
        if name == "sweep":
            with pytest.raises(FileFormatError, match="remove the dataset and sweep it again"):
                Store(copied)
        else:
            assert MoveLibrary(copied).between() == known


def test_better_figures_between_the_cells_are_not_believed(copied):
    known = MoveLibrary(copied).between()
    group = zarr.open_group(copied, mode="r+")
    entries = json.loads(group.attrs["moves between the cells"])
    group.attrs["moves between the cells"] = json.dumps(entries | {"residual": 0.0})
    assert MoveLibrary(copied).between() == known


@pytest.mark.parametrize("value", [math.nan, 0.6])
def test_an_axis_of_the_dataset_is_the_one_that_was_asked_for(copied, value):
    set_first(copied, "target", lambda _: value)
    with pytest.raises(FileFormatError, match="axis target has other values"):
        Store(copied)


def test_jumps_follow_from_the_rest_and_are_marked_anew(copied):
    set_first(copied, JUMP, lambda _: 1)
    store = Store(copied)
    store.mark_jumps()
    assert not store.read(JUMP).any()


def _keys(document, before=()):
    """Where every entry of a JSON document is, at any depth."""
    yield before
    entries = document.items() if isinstance(document, dict) else ()
    for key, entry in entries:
        yield from _keys(entry, (*before, key))


def _with(document, place, value):
    if not place:
        return value
    return {**document, place[0]: _with(document[place[0]], place[1:], value)}


@pytest.mark.slow
@pytest.mark.parametrize("name", [".", "coefficients", "target"])
def test_any_entry_of_a_description_may_be_anything(copied, caplog, call, name):
    path = copied / name / "zarr.json"
    description = json.loads(path.read_text())
    told = 0
    for place in _keys(description):
        for value in ([], 3, None):
            path.write_text(json.dumps(_with(description, place, value)))
            status, _, err = call(f"plan --from {copied} --target 40deg --duration 0.9")
            if status != 0:  # of what plays no part, as a unit, nothing is said
                assert (status, err.count("\n")) == (2, 1), place
                assert str(copied) in err
                assert "; " in err
                told += 1
    assert told > 10
    assert not caplog.records  # what zarr does at once elsewhere says nothing either


@pytest.mark.slow
def test_nothing_is_said_of_what_zarr_leaves_unfinished(copied):
    path = copied / "coefficients" / "zarr.json"
    description = json.loads(path.read_text())
    encoding = {"name": "default", "configuration": {"separator": []}}
    path.write_text(json.dumps({**description, "chunk_key_encoding": encoding}))
    line = ["plan", "--from", str(copied), "--target", "40deg", "--duration", "0.9"]
    ended = subprocess.run([*COARSELY, *line], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stderr.count("\n")) == (2, 1)
    assert f"{path} is damaged, changed or of another version" in ended.stderr
    assert "remove the dataset and sweep it again" in ended.stderr


@pytest.mark.slow_after(3)
@pytest.mark.parametrize("name", ["zarr.json", "energy/zarr.json", "coefficients/c/0/0/0"])
@pytest.mark.parametrize("kind", ["pipe", "device", "huge"])
def test_a_dataset_whose_files_never_end_is_not_read(copied, call, name, kind):
    file = copied / name
    file.unlink()
    if kind == "pipe":
        os.mkfifo(file)
    elif kind == "device":
        file.symlink_to("/dev/zero")
    else:
        file.touch()
        os.truncate(file, 10**11)
    words = "has 100000 MB; a file of a dataset has at most" if kind == "huge" else "no ordinary"
    for line in (
        f"plan --from {copied} --target 40deg --duration 0.9",
        f"export {copied} --output moves.c",
        f"explore {copied} --no-browser",
    ):
        status, out, err = call(line)
        assert (status, out, err.count("\n")) == (2, "", 1), line
        assert words in err
