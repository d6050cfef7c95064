"""The solver of a sweep: what its dataset states, also one of before."""

import pytest

import quietarm as qa
from quietarm.ocp.saved import plain, typed
from quietarm.studies.sweep.definition import Definition, PlanSettings
from quietarm.studies.sweep.grid_cells import plan_cells
from quietarm.studies.sweep.move_grid import Axis, MoveGrid

GRID = MoveGrid(
    qa.PointToPoint(qa.SingleLinkManipulator(), target=0.5, duration=0.8),
    (Axis("target", (0.4, 0.5), "rad"),),
)
OWN = qa.Ipopt(tolerance=1e-7, iterations=300)


def definition(solver):
    return Definition(GRID, qa.CycloidPolynomial(2), PlanSettings.of(None, None, solver))


def test_a_dataset_states_its_solver():
    stated = typed(plain(definition(OWN)), Definition)
    assert stated == definition(OWN)
    assert stated.settings.solver == OWN
    names = stated.difference(definition(qa.Sqp()))
    assert set(names.split(", ")) == {"solver", "solver_tolerance", "solver_iterations"}


def test_a_dataset_of_before_states_a_name():
    document = plain(definition(qa.Sqp()))
    document["settings"] = {  # as it was written before solvers had options
        "residual_limit": 0.0, "bound": None, "starts": 1, "seed": 0, "steps": None,
        "guess": None, "solver": "sqp", "log": False,
    }  # fmt: skip
    before = typed(document, Definition)
    assert before == definition(qa.Sqp())
    assert not before.difference(definition(qa.Sqp()))


def test_cells_are_planned_by_the_solver_of_the_sweep(monkeypatch):
    seen = []
    solve = qa.Ipopt.solve

    def noted(self, *args, **settings):
        seen.append(self)
        return solve(self, *args, **settings)

    monkeypatch.setattr(qa.Ipopt, "solve", noted)
    tasks = GRID.tasks((slice(0, 2),))
    cells = plan_cells(definition(OWN), tasks, cold=False)
    assert cells["energy"].notna().all()
    assert set(seen) == {OWN}


def test_a_sweep_takes_no_name_of_a_solver(tmp_path):
    with pytest.raises(TypeError, match=r"give an object, such as Ipopt\(\)"):
        qa.sweep(GRID.task, axes={"target": [0.4]}, path=tmp_path / "x.zarr", solver="ipopt")
