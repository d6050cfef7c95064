"""What `quietarm robustness` shows and writes: a table, its meaning, a picture, the samples."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp import Plan, Robustness, Sweep
from quietarm.ocp.robustness.measures import TOLERATED
from quietarm.studies.display.words import REST, move_of, plant_words
from quietarm.studies.document.blocks import Bullets, Document, Picture, Section
from quietarm.studies.document.table import Cell, Column, Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SHARES = {50: "median of the samples", 95: "95 % of them within", 100: "largest of them"}
_DIGITS, _LENGTH = "{:.5g}".format, "{:.3g}".format
_TOLERATED = f"within {100 * TOLERATED:g} %"
Figured = Mapping[str, tuple[Plan, Robustness]]
"""Every plan with its figures, by what it is called."""


def robustness_table(plans: Figured) -> Table:
    """The figures of every plan."""
    lines = _lines(next(iter(plans.values()))[1])
    columns = [Column("plan"), Column("plant"), Column("move"), Column("profile")]
    rows: list[list[Cell]] = []
    for label, (plan, found) in plans.items():
        task = plan.task
        row: list[Cell] = [label, plant_words(task.plant), move_of(task), plan.profile.label]
        rows.append([*row, *(cell(found) for _, cell in lines)])
    return Table("", [*columns, *(column for column, _ in lines)], rows)


def _summary(plans: Figured) -> Table:
    """A row for each plan: what it costs, what it leaves, and how far its plant may be wrong."""
    some = next(iter(plans.values()))[1]
    heads = ["energy [J]", "residual [mm]", "95 % of samples", "largest"]
    columns = ["plan", *heads, *(f"{sweep.name} {_TOLERATED}" for sweep in some.sweeps)]
    rows: list[list[Cell]] = []
    for label, (plan, found) in plans.items():
        left = [plan.residual, *(found.percentile("residual", share) for share in (95, 100))]
        lengths = [_LENGTH(1e3 * one) if one > REST else "rest" for one in left]
        ends = [sweep.insensitivity for sweep in found.sweeps]
        tolerated = [f"{100 * e[0]:.2g} to {100 * e[1]:.2g} %" if e else "none" for e in ends]
        rows.append([label, _DIGITS(plan.energy), *lengths, *tolerated])
    return Table("", [Column(column) for column in columns], rows).turned()


_Line = tuple[Column, Callable[[Robustness], float | None]]


def _lines(some: Robustness) -> list[_Line]:
    """Every figure, with how it is read off the figures of a plan."""
    lines: list[_Line] = [
        (Column("plain cycloid leaves [mm]", _LENGTH, "cycloid_residual_mm"),
         lambda found: 1e3 * found.cycloid),
    ]  # fmt: skip
    lines += _of_figure("residual", "mm", 1e3, _LENGTH)
    for i in range(len(some.sweeps)):
        lines += _of_sweep(i, some.sweeps[i])
    lines += _of_figure("energy", "J", 1.0, _DIGITS)
    lines += _of_figure("peak_torque", "N m", 1.0, _DIGITS)
    return lines


def _of_figure(name: str, unit: str, scale: float, form: Callable[[float], str]) -> list[_Line]:
    words, key = name.replace("_", " "), f"{name}_{unit.replace(' ', '')}"

    def percentile(share: float) -> Callable[[Robustness], float]:
        return lambda found: scale * found.percentile(name, share)

    return [
        (Column(f"{words} [{unit}]", form, key),
         lambda found: scale * float(getattr(found.assumed, name)[0])),
        *((Column(f"  {word}", form, f"{key}_p{share}"), percentile(share))
          for share, word in _SHARES.items()),
    ]  # fmt: skip


def _of_sweep(number: int, sweep: Sweep) -> list[_Line]:
    name, size = sweep.name, f"{100 * float(sweep.errors[-1]):g} %"

    def residual(pick: Callable[[NDArray[np.float64]], float]) -> Callable[[Robustness], float]:
        return lambda found: 1e3 * float(pick(found.sweeps[number].figures.residual))

    def end(which: int) -> Callable[[Robustness], float | None]:
        def read(found: Robustness) -> float | None:
            ends = found.sweeps[number].insensitivity
            return None if ends is None else 100 * ends[which]

        return read

    return [
        (Column(f"  {name} -{size}", _LENGTH, f"residual_{name}_lower_mm"), residual(_first)),
        (Column(f"  {name} +{size}", _LENGTH, f"residual_{name}_higher_mm"), residual(_last)),
        (Column("    largest between", _LENGTH, f"residual_{name}_largest_mm"), residual(np.max)),
        (Column(f"    {_TOLERATED} from [%]", _LENGTH, f"{name}_tolerated_from_percent"), end(0)),
        (Column("      to [%]", _LENGTH, f"{name}_tolerated_to_percent"), end(1)),
    ]  # fmt: skip


def _first(values: NDArray[np.float64]) -> float:
    return values[0]


def _last(values: NDArray[np.float64]) -> float:
    return values[-1]


def how_to_read(plans: Figured) -> list[str]:
    """What the figures mean, a sentence or two each."""
    some = next(iter(plans.values()))[1]
    return [
        "The joint follows the planned path whatever the plant; energy and torque are what that "
        "takes. An error of the frequency or of the damping is one of all modes alike.",
        f"{_TOLERATED.capitalize()}: the errors around none up to which the residual stays "
        f"within {100 * TOLERATED:g} % of what the plain cycloid of the same duration leaves on "
        "the assumed plant, all else as assumed; empty where it is above without an error. At an "
        "end of the range it may reach farther.",
        f"Samples: {len(some.errors)}, seed {some.seed}, all errors at once and uniform within "
        f"{', '.join(f'+-{100 * size:g} % of {name}' for name, size in some.ranges.items())}.",
    ]


def robustness_document(plans: Figured) -> Document:
    """The table, how to read it, the picture; and every curve and sample."""

    def picture() -> Figure:
        from quietarm.studies.figures.robustness import robustness_figure

        return robustness_figure({label: figures for label, (_, figures) in plans.items()})

    table = robustness_table(plans)
    return Document(
        "Robustness",
        [
            *([_summary(plans)] if len(plans) > 1 else []),
            table,
            Section("How to read it", [Bullets(how_to_read(plans), soft=True)]),
            Picture("robustness.png", picture, "Residual over errors"),
        ],
        {"robustness": table, "sweeps": _sweeps(plans), "samples": _samples(plans)},
    )


_FIGURES = tuple(Column(name) for name in ("residual_m", "energy_J", "peak_torque_Nm"))


def _sweeps(plans: Figured) -> Table:
    """Every point of every curve, a row each."""
    rows: list[list[Cell]] = []
    for label, (_, found) in plans.items():
        for sweep in found.sweeps:
            columns = sweep.errors, *vars(sweep.figures).values()
            rows += [[label, sweep.name, *row] for row in zip(*map(list, columns), strict=True)]
    return Table("Sweeps", [Column("plan"), Column("of"), Column("error"), *_FIGURES], rows)


def _samples(plans: Figured) -> Table:
    """Every sample, a row each."""
    names = list(next(iter(plans.values()))[1].ranges)
    columns = [Column("plan"), *(Column(f"{name}_error") for name in names), *_FIGURES]
    rows: list[list[Cell]] = []
    for label, (_, found) in plans.items():
        entries = *found.errors.T, *vars(found.samples).values()
        rows += [[label, *row] for row in zip(*(e.tolist() for e in entries), strict=True)]
    return Table("Samples", columns, rows)
