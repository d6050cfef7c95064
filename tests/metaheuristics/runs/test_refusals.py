"""Checkpoints of something else than the search that is to go on."""

import dataclasses
import re

import pytest
from quietarm.metaheuristics import CONSTRICTION, INERTIA_2002, VEPSO, PaperNSGA2, search
from quietarm.metaheuristics.runs import keeping
from quietarm.metaheuristics.runs.settings import search_versions
from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, FileFormatError
from small_searches import BOUNDS, HALF, METHODS, TASKS, found, one_line, run


@pytest.fixture(scope="module")
def checkpoints(tmp_path_factory):
    """One finished checkpoint for each method."""
    folder = tmp_path_factory.mktemp("checkpoints")
    for method in TASKS:
        run(method, generations=3, checkpoint=folder / method)
    return folder


def _refused(path, error, *words, **call):
    before, seen = (path.read_bytes(), path.stat().st_mtime_ns), []
    method, task = call.pop("method"), call.pop("task")
    with pytest.raises(error) as caught:
        run(method, task, resume=path, checkpoint=path, report=seen.append, **call)
    for word in (str(path), *words):
        assert word in str(caught.value)
    assert "\n" not in str(caught.value)
    assert seen == []
    assert (path.read_bytes(), path.stat().st_mtime_ns) == before


@METHODS
@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"target": 1.25}, ["target", "1.25"]),
        ({"start": 0.125}, ["start", "0.125"]),
        ({"duration": 0.75}, ["duration", "0.75", "0.8"]),
        ({"residual_window": 0.5}, ["residual_window", "0.5"]),
        ({"torque_limit": 0.625}, ["torque_limit", "0.625"]),
        ({"plant": SingleLinkManipulator(omega=11.5)}, ["plant", "11.5"]),
        ({"plant": ArmOnFlexibleLink(omega=8.5)}, ["plant", "8.5"]),
    ],
)
def test_a_checkpoint_of_another_task_is_refused(checkpoints, method, change, words):
    task = dataclasses.replace(TASKS[method], **change)
    other_plant = type(task.plant) is not type(TASKS[method].plant)
    words = ["plant", task.plant.name, TASKS[method].plant.name] if other_plant else words
    _refused(checkpoints / method, ValueError, *words, method=method, task=task, generations=3)


def test_the_difference_is_named_as_of_the_file_and_as_asked_for(tmp_path):
    limited, path = dataclasses.replace(TASKS["vepso"], torque_limit=0.3), tmp_path / "checkpoint"
    run("vepso", limited, generations=2, checkpoint=path)
    with pytest.raises(ValueError, match=r"its torque_limit is 0\.3, not None; ask for the"):
        run("vepso", generations=2, resume=path)
    run("vepso", generations=2, checkpoint=path)
    with pytest.raises(ValueError, match=r"its torque_limit is None, not 0\.3; ask for"):
        run("vepso", limited, generations=2, resume=path)


@METHODS
@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"bound": 0.375}, ["bound", "0.375"]),
        ({"population": 22}, ["population", "20", "22"]),
        ({"generations": 33}, ["generations", "3", "33"]),
        ({"seed": 77}, ["seed", "0", "77"]),
        ({"profile": CycloidPolynomial(5)}, ["profile", "5", "6"]),
    ],
)
def test_a_checkpoint_with_other_settings_is_refused(checkpoints, method, change, words):
    call = {"method": method, "task": TASKS[method], "generations": 3, **change}
    _refused(checkpoints / method, ValueError, *words, **call)


@METHODS
def test_a_checkpoint_of_the_other_method_is_refused(checkpoints, method):
    other = {"nsga2": "vepso", "vepso": "nsga2"}[method]
    call = {"task": TASKS[method], "bound": BOUNDS[method], "generations": 3}
    _refused(checkpoints / method, ValueError, "method", "nsga2", "vepso", method=other, **call)


@pytest.mark.parametrize(
    ("one", "other", "words"),
    [
        (
            VEPSO(particles=8, rule=INERTIA_2002),
            VEPSO(particles=8, rule=CONSTRICTION),
            ["rule"],
        ),
        (
            VEPSO(particles=8, boundary="clip"),
            VEPSO(particles=8, boundary="reflect"),
            ["boundary", "clip", "reflect"],
        ),
        (VEPSO(particles=8), VEPSO(particles=9), ["particles", "8", "9"]),
        (PaperNSGA2(8), PaperNSGA2(9), ["population", "8", "9"]),
    ],
    ids=["rule", "boundary", "particles", "population"],
)
def test_a_checkpoint_of_the_same_algorithm_with_other_settings_is_refused(
    tmp_path, one, other, words
):
    path = tmp_path / "checkpoint"
    search(HALF, one, bound=0.5, generations=3, checkpoint=path)
    before = path.read_bytes()
    with pytest.raises(ValueError, match=re.escape(str(path))) as caught:
        search(HALF, other, bound=0.5, generations=3, resume=path)
    for word in words:
        assert word in str(caught.value)
    one_line(caught)
    assert path.read_bytes() == before


@METHODS
def test_a_truncated_checkpoint_is_refused(tmp_path, checkpoints, method):
    path = tmp_path / "checkpoint"
    path.write_bytes((checkpoints / method).read_bytes()[:-400])
    _refused(path, FileFormatError, method=method, task=TASKS[method], generations=3)


@METHODS
def test_a_front_is_not_a_checkpoint(tmp_path, method):
    path = tmp_path / "front.json"
    found(method).save(path)
    _refused(path, FileFormatError, "not a checkpoint", method=method, task=TASKS[method])


def test_a_missing_checkpoint_is_named(tmp_path):
    with pytest.raises(FileFormatError, match="no such file"):
        run("nsga2", resume=tmp_path / "missing")


@METHODS
@pytest.mark.parametrize("package", ["quietarm", "casadi", "numpy", "pymoo"])
def test_a_checkpoint_of_other_software_is_refused(checkpoints, monkeypatch, method, package):
    others = {**search_versions(), package: "0.0.7"}
    monkeypatch.setattr(keeping, "search_versions", lambda: others)
    words = [f"its version of {package} is", "not '0.0.7'", "begin anew"]
    call = {"method": method, "task": TASKS[method], "generations": 3}
    _refused(checkpoints / method, ValueError, *words, **call)
