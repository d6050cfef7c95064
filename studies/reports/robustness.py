"""What `quietarm robustness` shows and writes: a table, its meaning, a picture, the samples."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from quietarm.ocp import Plan, Robustness, Sweep
from quietarm.ocp.profiles.shaped_cycloid import TOLERATED
from quietarm.studies import figures
from quietarm.studies.display.words import REST, move_of, moved
from quietarm.studies.document.blocks import Bullets, Document, Picture, Section
from quietarm.studies.document.table import Cell, Column, Table

_SHARES = {50: "median of the samples", 95: "95 % of them within", 100: "largest of them"}
_DIGITS, _LENGTH = "{:.5g}".format, "{:.3g}".format
_TOLERATED = f"within {100 * TOLERATED:g} %"
Figured = Mapping[str, tuple[Plan, Robustness]]
"""Every plan with its figures, by what it is called."""


def _table(plans: Figured) -> Table:
    """The figures of every plan."""
    columns = [Column("plan"), Column("plant"), Column("move"), Column("profile")]
    columns += [column for column, _ in _figures(next(iter(plans.values()))[1])]
    rows: list[list[Cell]] = []
    for label, (plan, found) in plans.items():
        task, cells = plan.task, (cell for _, cell in _figures(found))
        rows.append([label, moved(task), move_of(task), plan.profile.label, *cells])
    return Table("", columns, rows)


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


def _figures(found: Robustness) -> Iterator[tuple[Column, Cell]]:
    """Every figure of a plan, and its column."""
    yield Column("plain cycloid leaves [mm]", _LENGTH, "cycloid_residual_mm"), 1e3 * found.cycloid
    yield from _of_samples(found, "residual", "mm", 1e3, _LENGTH)
    for sweep in found.sweeps:
        yield from _of_sweep(sweep)
    yield from _of_samples(found, "energy", "J", 1.0, _DIGITS)
    yield from _of_samples(found, "peak_torque", "N m", 1.0, _DIGITS)


def _of_samples(
    found: Robustness, name: str, unit: str, scale: float, form: Callable[[float], str]
) -> Iterator[tuple[Column, Cell]]:
    words, key = name.replace("_", " "), f"{name}_{unit.replace(' ', '')}"
    yield Column(f"{words} [{unit}]", form, key), scale * float(getattr(found.assumed, name)[0])
    for share, word in _SHARES.items():
        yield Column(f"  {word}", form, f"{key}_p{share}"), scale * found.percentile(name, share)


def _of_sweep(sweep: Sweep) -> Iterator[tuple[Column, Cell]]:
    name, size = sweep.name, f"{100 * float(sweep.errors[-1]):g} %"
    left, ends = 1e3 * sweep.figures.residual, sweep.insensitivity
    low, high = (None, None) if ends is None else (100 * end for end in ends)
    for words, key, cell in (
        (f"  {name} -{size}", f"residual_{name}_lower_mm", float(left[0])),
        (f"  {name} +{size}", f"residual_{name}_higher_mm", float(left[-1])),
        ("    largest between", f"residual_{name}_largest_mm", float(left.max())),
        (f"    {_TOLERATED} from [%]", f"{name}_tolerated_from_percent", low),
        ("      to [%]", f"{name}_tolerated_to_percent", high),
    ):
        yield Column(words, _LENGTH, key), cell


def _how_to_read(plans: Figured) -> list[str]:
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
    table, measured = _table(plans), {label: found for label, (_, found) in plans.items()}
    return Document(
        "Robustness",
        [
            *([_summary(plans)] if len(plans) > 1 else []),
            table,
            Section("How to read it", [Bullets(_how_to_read(plans), soft=True)]),
            Picture(
                "robustness.png",
                lambda: figures.robustness_figure(measured),
                "Residual over errors",
            ),
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
