"""Moves between the cells of a sweep."""

import math

import numpy as np
import pytest
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import Plan, PointToPoint, plan_move
from quietarm.studies.cli import main
from quietarm.studies.sweep.library import MoveLibrary

LINE = (
    "sweep single-link --target 20deg:60deg:5deg --duration 800ms:1.1s:50ms --quiet "
    "--output moves.zarr"
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sweep")
    with pytest.raises(SystemExit) as ended:
        main([*LINE.split()[:-1], str(folder / "moves.zarr")])
    assert ended.value.code == 0
    return folder


@pytest.fixture(autouse=True)
def _standing_there(folder, monkeypatch):
    monkeypatch.chdir(folder)


def test_a_cell_is_what_it_was_and_between_it_is_as_still_as_stated():
    library = MoveLibrary("moves.zarr")
    cell = library.coefficients(target=math.radians(30), duration=0.9)
    assert cell == pytest.approx(library._cells[2, 2], abs=1e-12)
    stated = library.between()
    assert stated.samples == 100
    assert stated.residual < 0.2e-3
    found = library.plan(target=math.radians(37), duration=0.93)
    assert found.residual <= stated.residual
    own = plan_move(PointToPoint(SingleLinkManipulator(), math.radians(37), 0.93))
    # what is not at rest may be a little cheaper
    assert own.energy * (1 - 1e-2) < found.energy <= own.energy * (1 + max(stated.excess, 1e-4))
    assert MoveLibrary("moves.zarr").between() == stated  # kept


def test_many_moves_are_looked_up_at_once():
    library, random = MoveLibrary("moves.zarr"), np.random.default_rng(0)
    target, duration = random.uniform(0.4, 1.0, 1000), random.uniform(0.8, 1.1, 1000)
    found = library.coefficients(target=target, duration=duration)
    assert found.shape == (1000, 6)
    one = library.coefficients(target=target[7], duration=duration[7])
    assert found[7] == pytest.approx(one, rel=1e-9)


def test_next_to_a_cell_without_a_plan_and_across_a_jump_nothing_is_looked_up():
    library = MoveLibrary("moves.zarr")
    cells = library._cells.copy()
    cells[4, 3] = np.nan
    library.__dict__["_cells"] = cells
    with pytest.raises(ValueError, match="next to a cell without a plan"):
        library.coefficients(target=math.radians(41), duration=0.96)
    library.coefficients(target=math.radians(25), duration=0.85)


def test_the_command_writes_the_move(call):
    code, out, err = call(
        "lookup moves.zarr --target 37deg --duration 930ms --quiet --output p.json --csv p.csv"
    )
    assert (code, err) == (0, "")
    assert "more energy than plans of their own, of 100 random moves" in " ".join(out.split())
    assert Plan.load("p.json").task.target == pytest.approx(math.radians(37))


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("moves.zarr --target 70deg --duration 0.9", "target is 1.22173 rad, and the grid has"),
        ("moves.zarr --target 30deg", "give a value of each axis, target, duration"),
        ("moves.zarr --target 30deg --duration 0.9 --set omega=9", "and no other"),
        ("nowhere.zarr --target 30deg --duration 0.9", "nowhere.zarr is no dataset of a sweep"),
    ],
)
def test_what_is_not_there_is_refused(call, line, said):
    code, out, err = call(f"lookup {line} --quiet")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert said in err
