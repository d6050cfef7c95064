"""Moves between the cells of a sweep."""

import math
import shutil
from ctypes import c_double

import numpy as np
import pytest
import xarray as xr
from c_library import compiled, joint_by, needs_compiler

from quietarm.models import SingleLinkManipulator
from quietarm.ocp import (
    CycloidPolynomial,
    FileFormatError,
    PointToPoint,
    Uncertainty,
    plan_move,
)
from quietarm.ocp.solvers.ipopt import Ipopt
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.studies.cli import main
from quietarm.studies.sweep.cell_interpolation import Interpolation
from quietarm.studies.sweep.library import MoveLibrary, plan_from
from quietarm.studies.sweep.run import sweep

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


@pytest.mark.slow
def test_a_cell_is_what_it_was_and_between_it_is_as_still_as_stated():
    library = MoveLibrary("moves.zarr")
    cell = library.coefficients(target=math.radians(30), duration=0.9)
    kept = xr.open_zarr("moves.zarr", consolidated=False).coefficients.values[2, 2]
    assert cell == pytest.approx(kept, abs=1e-12)
    stated = library.between()
    assert stated.samples == 100
    assert stated.residual < 0.2e-3
    found = library.plan(target=math.radians(37), duration=0.93)
    assert found.residual <= stated.residual
    own = plan_move(PointToPoint(SingleLinkManipulator(), math.radians(37), 0.93))
    # what is not at rest may be a little cheaper
    assert own.energy * (1 - 1e-2) < found.energy <= own.energy * (1 + max(stated.excess, 1e-4))
    assert MoveLibrary("moves.zarr").between() == stated  # kept


@pytest.mark.slow
@pytest.mark.parametrize(
    ("axis", "values"),
    [
        pytest.param("target", (math.radians(30), math.radians(40))),
        pytest.param("omega", (9.8, 10.2), marks=pytest.mark.slow),
    ],
)
def test_a_move_of_an_uncertain_plant_is_there_without_solving(
    done, tmp_path, monkeypatch, axis, values
):
    cells = tmp_path / "robust.zarr"
    task = PointToPoint(
        SingleLinkManipulator(), math.pi / 6, 0.8, uncertainty=Uncertainty({"frequency": 0.08})
    )
    axes = {axis: values, "duration": (0.8, 0.85, 0.9)}
    dataset = sweep(task, CycloidPolynomial(3), axes=axes, path=cells).load()
    typed = "--set omega={:.17g}" if axis == "omega" else "--target {:.17g}"
    monkeypatch.setattr(Sqp, "solve", None)
    monkeypatch.setattr(Ipopt, "solve", None)
    for value, duration in ((values[0], 0.85), (sum(values) / 2, 0.83)):  # on a cell, and between
        out = done(f"plan --from {cells} {typed.format(value)} --duration {duration}")
        assert "between the cells: residual" in out
        assert "worst case" in out
    done(f"export {cells} --output {tmp_path / 'moves.c'}")
    library = MoveLibrary(cells)
    plan = library.plan(**{axis: values[0], "duration": 0.85})
    assert plan.energy == pytest.approx(float(dataset.energy[0, 1]), rel=1e-9)
    stated = library.between()
    random = np.random.default_rng(1).uniform((values[0], 0.8), (values[1], 0.9), (10, 2))
    for value, duration in random.tolist():
        plan = library.plan(**{axis: value, "duration": duration})
        assert plan.residual <= plan.worst.residual <= 1.05 * stated.residual
        energy = library.energies(np.array([[value, duration]]))[0]
        # docs/sweeps.md: another move may be a little worse
        assert plan.energy <= (1 + stated.excess + 1e-3) * energy


@pytest.mark.slow
def test_between_cells_it_is_the_polynomial_through_the_nearest_six():
    axes = [np.linspace(0, 1, 9), np.array([0.0, 0.3, 0.4, 1.0, 1.7, 2.0, 2.2])]
    x, y = np.meshgrid(*axes, indexing="ij")

    def quintic(x, y):
        return np.stack([(x + 1) ** 5 - x * y**3, (y + 2) ** 5], axis=-1)

    places = np.random.default_rng(0).uniform((0, 0), (1, 2.2), (50, 2))
    found = Interpolation(axes, quintic(x, y))(places)
    assert found == pytest.approx(quintic(*places.T), rel=1e-12)  # exact up to degree five


@pytest.mark.slow
def test_no_polynomial_goes_through_a_cell_without_a_plan_or_across_a_jump():
    axes, cells = [np.arange(9.0)], np.arange(9.0)[:, None]
    cells[5:] += 100.0  # another motion
    cells[8] = np.nan
    between = Interpolation(axes, cells)
    assert between.orders.tolist() == [4, 4, 4, 2, 0, 2, 2, 0]
    found = between(np.array([[1.5], [4.0], [4.5], [7.0], [7.5]]))[:, 0]
    assert found == pytest.approx([1.5, 4.0, np.nan, 107.0, np.nan], nan_ok=True)


@pytest.mark.slow
def test_a_margin_makes_moves_between_the_cells_keep_their_limits(call, tmp_path):
    axes = "--target 60deg:90deg:10deg --duration 600ms:800ms:100ms"
    line, at = f"sweep single-link {axes} --acceleration-limit 80 --terms 6 --quiet", (1.48, 0.65)
    place, target, duration = tmp_path / "limited.zarr", *at
    assert call(f"{line} --output {place}")[0] == 0
    plan, between, trouble = plan_from(place, target=target, duration=duration)
    assert 80 * 1.01 < plan.motion.peak_acceleration <= 80 * between.of_limits
    assert "breaks its limit of acceleration; sweep again with --limit-margin" in str(trouble)
    code, _, err = call(f"export {place} --output {tmp_path / 'moves.c'}")
    assert (code, (tmp_path / "moves.c").exists()) == (1, False)
    assert between.remedy in err
    margin = between.remedy.split()[4]
    place = tmp_path / "kept.zarr"
    assert call(f"{line} --limit-margin {margin} --output {place}")[0] == 0
    plan, between, trouble = plan_from(place, target=target, duration=duration)
    assert (trouble, between.keeps_limits) == (None, True)
    assert plan.task.acceleration_limit == 80
    assert call(f"export {place} --output {tmp_path / 'moves.c'}")[0] == 0


@pytest.mark.slow
@needs_compiler
def test_a_controller_gets_the_same_coefficients_and_path(call, tmp_path):
    assert call(f"export moves.zarr --output {tmp_path / 'moves.c'}")[0] == 0
    code = compiled(tmp_path / "moves.c")
    target, duration, beyond, time = map(c_double, (0.65, 0.93, 3.0, 0.4))
    a = (c_double * 6)()
    assert [code.moves_plan(one, duration, a) for one in (beyond, target)] == [1, 0]
    library, at = MoveLibrary("moves.zarr"), {"target": 0.65, "duration": 0.93}
    assert list(a) == pytest.approx(library.coefficients(**at))
    path = library.plan(**at).path
    expected = [float(path(0.4, order)) for order in range(3)]
    assert joint_by(code.moves_at, a, target, duration, time) == pytest.approx(expected)


@pytest.mark.slow
@pytest.mark.parametrize("broken", ["coefficients/c/0/0/0", "zarr.json"])
def test_a_damaged_dataset_is_told_in_one_line(tmp_path, broken):
    place = tmp_path / "moves.zarr"
    shutil.copytree("moves.zarr", place)
    (place / broken).write_bytes(b"{}")
    with pytest.raises(FileFormatError) as refused:
        plan_from(place, target=0.5, duration=0.9)
    said = str(refused.value)
    assert "remove the dataset and sweep it again" in said or "is no dataset of a sweep" in said


@pytest.mark.slow
def test_what_is_not_in_the_dataset_is_refused_with_a_remedy():
    library = MoveLibrary("moves.zarr")
    within = "the grid has 0.349066 to 1.0472"
    for at, why in (({"target": 1.3}, within), ({"target": math.nan}, within), ({}, "each axis")):
        with pytest.raises(ValueError, match=why):
            library.coefficients(duration=0.9, **at)
