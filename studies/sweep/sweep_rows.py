"""A sweep on the screen: how many moves there are, what they cost, which cannot be."""

from __future__ import annotations

import numpy as np

from quietarm.ocp import SolveStatus
from quietarm.ocp.rest import is_at_rest
from quietarm.studies.sweep.definition import JUMP, STATES, STATUS
from quietarm.studies.sweep.move_grid import Axis
from quietarm.studies.sweep.store import Store
from quietarm.views.report.captions import caption_of_cells
from quietarm.views.report.words import counted, moved, residual_place, residual_words
from quietarm.views.tips import tip_scale


def sweep_answer(store: Store) -> str:
    """Return how many moves of a grid have a plan, and what these take and leave."""
    task = store.definition.grid.task
    return f"{caption_of_cells(store.read('energy'), store.read('residual'), task)}."


def sweep_rows(store: Store, *, verbose: bool = False) -> list[tuple[str, str]]:
    """Return the axes, how many cells ended how, and what a check from cold starts found."""
    grid = store.definition.grid
    status = store.read(STATUS)
    energy = store.read("energy")
    rows = [("plant", moved(grid.task))]
    rows += [
        (
            axis.name,
            f"{len(axis.values)} from {values[0]:.4g} to {values[-1]:.4g} {unit}",
        )
        for axis in grid.axes
        for unit, values in [_shown_values(axis)]
    ]
    known = np.isfinite(energy)
    rows.append(("dataset", str(store.path)))
    solved_states = (SolveStatus.OPTIMAL.value, SolveStatus.ACCEPTABLE.value)
    counts = [(state, int((status == k).sum())) for k, state in enumerate(STATES)]
    unsolved = [count for count in counts if count[0] not in solved_states]
    rows += [(state, counted(count, "move")) for state, count in unsolved if count]
    if known.any():
        jumps = int((store.read(JUMP) > 0).sum())
        largest = residual_words(float(store.read("residual")[known].max()), grid.task)
        largest = f"at {largest}" if largest == "rest" else f"at most {largest}"
        rows += [
            ("energy", f"{energy[known].min():.4g} to {energy[known].max():.4g} J"),
            ("residual", f"{largest} {residual_place(grid.task)}"),
        ]
        rows += figure_spans(store)
        rows += [("cold starts", _cold_words(store, verbose))]
        rows += [("jumps", f"to another kind of motion, {counted(jumps, 'time')}")] * bool(jumps)
    return rows


def _cold_words(store: Store, verbose: bool) -> str:
    """Return whether moves that were solved afresh, not from neighbours, got better plans."""
    excess = store.read("cold_excess")
    checked = excess[np.isfinite(excess)]
    most = float(checked.max(initial=0.0))
    detail = f" (at most {most:.1g} of the energy less)" if verbose else ""
    if most <= _BETTER:
        return f"found no better plan for {counted(len(checked), 'move')}{detail}"
    return f"found up to {most:.2%} less energy, {counted(len(checked), 'move')} checked"


_BETTER = 1e-4
"""Share of the energy from which on a plan from a cold start counts as better."""


def _shown_values(axis: Axis) -> tuple[str, list[float]]:
    """Return the unit and values of an axis as they are shown: angles in degrees."""
    if axis.unit == "rad":
        return "deg", np.degrees(axis.values).tolist()
    return axis.unit, list(axis.values)


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
    unit, values = _shown_values(axis)
    cells = {
        f"{axis.name} [{unit}]": [f"{value:.4g}" for value in values],
        "energy [J]": np.where(known, [f"{value:.4g}" for value in energy.tolist()], "-"),
        f"residual [{shown}]": np.where(known, residuals, "-"),
        **figures,
        "status": [STATES[k] for k in status.tolist()],
    }
    return ["\n", *pandas.DataFrame(cells).to_string(index=False).splitlines()]
