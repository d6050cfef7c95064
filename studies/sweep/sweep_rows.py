"""A sweep on the screen: how many moves there are, what they cost, which cannot be."""

from __future__ import annotations

import numpy as np

from quietarm.ocp import SolveStatus
from quietarm.ocp.rest import is_at_rest
from quietarm.studies.sweep.definition import JUMP, STATES, STATUS
from quietarm.studies.sweep.store import Store
from quietarm.views.report.words import moved, residual_place
from quietarm.views.tips import tip_scale, tip_words


def sweep_rows(store: Store) -> list[tuple[str, str]]:
    """Axes, then how many cells ended how."""
    grid = store.definition.grid
    status = store.read(STATUS)
    energy = store.read("energy")
    rows = [("plant", moved(grid.task))]
    rows += [
        (
            axis.name,
            f"{len(axis.values)} from {axis.values[0]:.6g} to {axis.values[-1]:.6g} {axis.unit}",
        )
        for axis in grid.axes
    ]
    known = np.isfinite(energy)
    solved = f"{known.sum()} of {grid.cells}"
    rows.append(("moves", f"{solved} have a plan, in {store.path}"))
    solved_states = (SolveStatus.OPTIMAL.value, SolveStatus.ACCEPTABLE.value)
    counts = [(state, int((status == k).sum())) for k, state in enumerate(STATES)]
    unsolved = [count for count in counts if count[0] not in solved_states]
    rows += [(state, f"{count} cells") for state, count in unsolved if count]
    if known.any():
        excess = store.read("cold_excess")
        jumps = int((store.read(JUMP) > 0).sum())
        checked = np.isfinite(excess)
        largest = store.read("residual")[known].max()
        tip_unit = grid.task.plant.tip_unit
        rows += [
            ("energy", f"{energy[known].min():.4g} to {energy[known].max():.4g} J"),
            ("residual", f"{tip_words(largest, tip_unit)} at most {residual_place(grid.task)}, "
             "by CVODES"),
            ("from cold starts", f"at most {max(excess[checked].max(), 0):.1g} of the energy less, "
             f"in {checked.sum()} cells"),
        ]  # fmt: skip
        rows += figure_spans(store)
        rows += [("jumps", f"after {jumps} cells, to another motion")] * bool(jumps)
    return rows


def figure_spans(store: Store) -> list[tuple[str, str]]:
    """Return the range over the cells of each figure of a user's own, as its label and words."""
    plant = store.definition.grid.task.plant
    spans = list[tuple[str, str]]()
    for figure in store.figures:
        values = store.read(figure.name)
        if np.isfinite(values).any():
            low = f"{np.nanmin(values):.{figure.digits}g}"
            high = figure.words(float(np.nanmax(values)), plant)
            spans.append((figure.label_on(plant), f"{low} to {high}"))
    return spans


def cells_along(store: Store) -> list[str]:
    """The trade-off along the only axis, a line a cell; none where there are more or many."""
    # cells along one axis that are listed
    most_lines = 30
    import pandas  # not at the top: it takes long to load

    axis, *more_axes = store.definition.grid.axes
    if more_axes or len(axis.values) > most_lines:
        return []
    status, energy, residual = (store.read(name) for name in (STATUS, "energy", "residual"))
    task = store.definition.grid.task
    shown, factor = tip_scale(task.plant.tip_unit)
    residuals = [
        "rest" if is_at_rest(value, task) else f"{factor * value:.4g}"
        for value in residual.tolist()
    ]
    known = np.isfinite(energy)
    plant = store.definition.grid.task.plant
    figures = {
        f"{figure.label_on(plant)} [{figure.unit_on(plant) or '-'}]": [
            f"{value:.{figure.digits}g}" if np.isfinite(value) else "-"
            for value in store.read(figure.name).tolist()
        ]
        for figure in store.figures
    }
    cells = {
        f"{axis.name} [{axis.unit}]": [f"{value:.6g}" for value in axis.values],
        "energy [J]": np.where(known, [f"{value:.4g}" for value in energy.tolist()], "-"),
        f"residual [{shown}]": np.where(known, residuals, "-"),
        **figures,
        "status": [STATES[k] for k in status.tolist()],
    }
    return ["\n", *pandas.DataFrame(cells).to_string(index=False).splitlines()]
