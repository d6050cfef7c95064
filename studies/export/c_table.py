"""The moves of a sweep as C: a table of coefficients and what interpolates it."""

from __future__ import annotations

import numpy as np
from quietarm.studies.display.words import moved
from quietarm.studies.export.c_source import name_in_c, rendered, statements
from quietarm.studies.sweep.grid import OF_MOVES
from quietarm.studies.sweep.interpolation import ORDERS
from quietarm.studies.sweep.library import MoveLibrary


def c_table_files(library: MoveLibrary, name: str) -> tuple[str, str]:
    """Header and source of a library's moves, whose functions are called after a file's name."""
    name_in_c(name)
    grid, size = library.grid, library.profile.size
    names, between = [axis.name for axis in grid.axes], library.interpolation
    falling = tuple(k for k, axis in enumerate(between.axes) if axis[-1] < axis[0])
    task = dict(zip(OF_MOVES, grid.task.move, strict=True))
    inputs = ["t", *(f"coefficients[{i}]" for i in range(size)), *OF_MOVES]
    return rendered(
        "moves", name, *statements(library.profile, inputs),
        plant=moved(grid.task).replace("*/", ""),
        version=library.store.versions.get("quietarm", ""),
        figures=library.between().words,
        size=size,
        most=max(ORDERS),
        names=names,
        values=[f"{axis.name} [{axis.unit}]" for axis in grid.axes],
        move_axes=[one for one in names if one in OF_MOVES],
        constants={one: value for one, value in task.items() if one not in names},
        axes=zip(names, map(np.sort, between.axes), strict=True),
        lengths=between.lengths,
        orders=np.flip(between.orders, falling).reshape(-1, between.orders.shape[-1]),
        cells=np.nan_to_num(np.flip(between.cells, falling)).reshape(-1, size),
    )  # fmt: skip
