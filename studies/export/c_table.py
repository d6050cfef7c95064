"""The moves of a sweep as C: a table of coefficients and what interpolates it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from quietarm.studies.display.words import plant_words
from quietarm.studies.export.c_source import name_in_c, number, statements
from quietarm.studies.sweep.grid import OF_MOVES
from quietarm.studies.sweep.interpolation import ORDERS, Interpolation
from quietarm.studies.sweep.library import MoveLibrary

_HEADER = """/* {name}: moves of {plant}. By quietarm {version}.
   {between}. */
#ifndef {guard}
#define {guard}

#define {guard}_COEFFICIENTS {size}

/* Coefficients of the move at {values}.
   Returns 0; or, without writing any, 1 beyond the grid and 2 next to a cell without a plan or
   at a change of motion. */
int {name}_plan({axes}, double coefficients[{size}]);

/* The joint's angle [rad], speed [rad/s] and acceleration [rad/s^2] on such a move, a time [s]
   after its start. */
void {name}_at(const double coefficients[{size}]{move_axes}, double time,
    double *angle, double *speed, double *acceleration);

#endif
"""
_SOURCE = """/* {name}: moves of {plant}. By quietarm {version}. */
#include "{name}.h"

#include <math.h>

#define AXES {count}
#define MOST {most}

{tables}
static const double *const values[AXES] = {{{value_names}}};
static const int lengths[AXES] = {{{lengths}}};

/* Cells along an axis that the polynomial of each box goes through; 0 where there is none. */
static const unsigned char orders[] = {{
{orders}
}};
static const double cells[][{size}] = {{
{cells}
}};

int {name}_plan({axes}, double coefficients[{size}])
{{
    const double at[AXES] = {{{names}}};
    int first[AXES], width[AXES], node[AXES], box = 0, order, i, j, k, cell;
    double weights[AXES][MOST], weight;

    for (k = 0; k < AXES; k++) {{
        if (!(at[k] >= values[k][0] && at[k] <= values[k][lengths[k] - 1]))
            return 1;
        for (j = 0; j < lengths[k] - 2 && at[k] >= values[k][j + 1]; j++)
            ;
        first[k] = j;
        box = box * (lengths[k] - 1) + j;
    }}
    order = orders[box];
    if (order == 0)
        return 2;
    for (k = 0; k < AXES; k++) {{
        width[k] = order < lengths[k] ? order : lengths[k];
        first[k] -= width[k] / 2 - 1;
        if (first[k] > lengths[k] - width[k])
            first[k] = lengths[k] - width[k];
        if (first[k] < 0)
            first[k] = 0;
        for (i = 0; i < width[k]; i++) {{
            const double *nodes = values[k] + first[k];
            weights[k][i] = 1.0;
            for (j = 0; j < width[k]; j++)
                if (j != i)
                    weights[k][i] *= (at[k] - nodes[j]) / (nodes[i] - nodes[j]);
        }}
        node[k] = 0;
    }}
    for (i = 0; i < {size}; i++)
        coefficients[i] = 0.0;
    for (;;) {{
        weight = 1.0;
        cell = 0;
        for (k = 0; k < AXES; k++) {{
            weight *= weights[k][node[k]];
            cell = cell * lengths[k] + first[k] + node[k];
        }}
        for (i = 0; i < {size}; i++)
            coefficients[i] += weight * cells[cell][i];
        for (k = AXES - 1; k >= 0 && ++node[k] == width[k]; k--)
            node[k] = 0;
        if (k < 0)
            return 0;
    }}
}}

void {name}_at(const double coefficients[{size}]{move_axes}, double time,
    double *angle, double *speed, double *acceleration)
{{
{constants}    double t, {variables};

    if (time <= 0.0 || time >= duration) {{
        *angle = time <= 0.0 ? start : target;
        *speed = 0.0;
        *acceleration = 0.0;
        return;
    }}
    t = time / duration;
{lines}
}}
"""


def c_table_files(library: MoveLibrary, name: str) -> tuple[str, str]:
    """Header and source of a library's moves, whose functions are called after a file's name.

    Raises
    ------
    ValueError
        When no function of C can be called so.
    """
    name_in_c(name)
    grid, size = library.grid, library.profile.size
    rising = _rising(library.interpolation)
    names = [axis.name for axis in grid.axes]
    inputs = ["t", *(f"coefficients[{i}]" for i in range(size)), *OF_MOVES]
    variables, lines = statements(library.profile, inputs)
    of_moves = [axis for axis in names if axis in OF_MOVES]
    task = dict(zip(OF_MOVES, grid.task.move, strict=True))
    constants = [f"    const double {one} = {number(value)};\n"
                 for one, value in task.items() if one not in names]  # fmt: skip
    flat = rising.cells.reshape(-1, size)
    words = {
        "name": name,
        "guard": name.upper(),
        "plant": plant_words(grid.task.plant).replace("*/", ""),
        "version": library.store.versions.get("quietarm", ""),
        "between": library.between().words,
        "size": size,
        "count": len(names),
        "most": max(ORDERS),
        "values": ", ".join(f"{axis.name} [{axis.unit}]" for axis in grid.axes),
        "names": ", ".join(names),
        "axes": ", ".join(f"double {one}" for one in names),
        "move_axes": "".join(f", double {one}" for one in of_moves),
        "tables": "\n".join(
            f"static const double values_{one}[] = {{{_numbers(values)}}};"
            for one, values in zip(names, rising.axes, strict=True)
        ),
        "value_names": ", ".join(f"values_{one}" for one in names),
        "lengths": ", ".join(map(str, rising.lengths.tolist())),
        "orders": "\n".join(
            "    " + ", ".join(map(str, row)) + ","
            for row in rising.orders.reshape(-1, rising.orders.shape[-1]).tolist()
        ),
        "cells": "\n".join(f"    {{{_numbers(np.nan_to_num(row))}}}," for row in flat),
        "constants": "".join(constants),
        "variables": ", ".join(variables),
        "lines": "\n".join(f"    {line}" for line in lines),
    }
    return _HEADER.format(**words), _SOURCE.format(**words)


def _rising(between: Interpolation) -> Interpolation:
    """The same with every axis rising."""
    falling = tuple(k for k, axis in enumerate(between.axes) if axis[-1] < axis[0])
    axes = [np.flip(axis) if k in falling else axis for k, axis in enumerate(between.axes)]
    turned = Interpolation(axes, np.flip(between.cells, falling), np.zeros((), np.int32))
    turned.lengths = between.lengths
    turned.__dict__["orders"] = np.flip(between.orders, falling)
    return turned


def _numbers(values: NDArray[np.float64]) -> str:
    return ", ".join(map(number, values.tolist()))
