"""A sweep on the screen: how many moves there are, what they cost, which cannot be."""

from __future__ import annotations

from math import isfinite

import numpy as np
from quietarm.ocp import SolveStatus
from quietarm.studies.display.words import REST, moved
from quietarm.studies.document.blocks import Document, Facts
from quietarm.studies.document.table import Cell, Column, Table
from quietarm.studies.sweep.definition import JUMP, STATES, STATUS
from quietarm.studies.sweep.store import Store

_MOST_LINES = 30
"""Cells along one axis that are listed."""


def sweep_document(store: Store) -> Document:
    """Axes, then how many cells ended how."""
    grid, status, energy = store.definition.grid, store.read(STATUS), store.read("energy")
    rows = [("plant", moved(grid.task))]
    rows += [
        (
            axis.name,
            f"{len(axis.values)} from {axis.values[0]:.6g} to {axis.values[-1]:.6g} {axis.unit}",
        )
        for axis in grid.axes
    ]
    known, solved = np.isfinite(energy), f"{np.isfinite(energy).sum()} of {grid.cells}"
    rows.append(("moves", f"{solved} have a plan, in {store.path}"))
    solved_states = (SolveStatus.OPTIMAL.value, SolveStatus.ACCEPTABLE.value)
    counts = [(state, int((status == k).sum())) for k, state in enumerate(STATES)]
    others = [each for each in counts if each[0] not in solved_states]
    rows += [(state, f"{count} cells") for state, count in others if count]
    if known.any():
        excess, jumps = store.read("cold_excess"), int((store.read(JUMP) > 0).sum())
        checked = np.isfinite(excess)
        rows += [
            ("energy", f"{energy[known].min():.4g} to {energy[known].max():.4g} J"),
            ("residual", f"{1e3 * store.read('residual')[known].max():.3g} mm at most, by CVODES"),
            ("from cold starts", f"at most {max(excess[checked].max(), 0):.1g} of the energy less, "
             f"in {checked.sum()} cells"),
        ]  # fmt: skip
        rows += [("jumps", f"after {jumps} cells, to another motion")] * bool(jumps)
    return Document("", [Facts(rows), *_along_one_axis(store)])


def _along_one_axis(store: Store) -> list[Table]:
    """The trade-off along the only axis, a line a cell; nothing where there are more or many."""
    axis, *others = store.definition.grid.axes
    if others or len(axis.values) > _MOST_LINES:
        return []
    heads = f"{axis.name} [{axis.unit}]", "energy [J]", "residual [mm]", "how it ended"
    status, energy, residual = (
        store.read(name).tolist() for name in (STATUS, "energy", "residual")
    )
    rows: list[list[Cell]] = []
    for k, value in enumerate(axis.values):
        known = isfinite(energy[k])
        left: Cell = "rest" if residual[k] < REST else 1e3 * residual[k]
        state = STATES[status[k]]
        rows.append([f"{value:.6g}", *((energy[k], left) if known else (None, None)), state])
    return [Table("cells", [Column(head) for head in heads], rows).turned()]
