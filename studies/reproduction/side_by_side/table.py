"""What stands side by side as tables: one for each move, and all of it as CSV."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from quietarm.studies.paper.case import Case
from quietarm.studies.report.document import Block, Bullets, Text
from quietarm.studies.report.table import Cell, Column, Table
from quietarm.studies.reproduction.side_by_side.results import FREQUENCY_ERROR, System

Systems = Mapping[Case, Sequence[System]]

_ERROR = f"{100 * FREQUENCY_ERROR:g} %"
LEGEND = (
    "Size: how many numbers are chosen. Residual, energy and peaks are by CVODES. "
    f"{_ERROR} off: the residual with all natural frequencies {_ERROR} lower or higher than "
    "assumed, the larger of the two, the joint moving as planned. Accel.: of the joint. Time: of "
    "one solve with its starts, or of one search, here; with the plain cycloid and the shapers "
    "nothing is looked for. ZV, ZVD, EI: input shapers for the plant's modes; their cycloid is "
    "shorter, so that the whole takes the duration. Paper: its coefficients for N = 6, a misprint "
    "mended; where it prints none, its printed energy. Network, Gaussians: what refs [23] and [24] "
    "move the joint with, as this project reads them; these and the spline by the gradient, at "
    "rest on arrival, weights up to 0.5. VEPSO, NSGA-II: the paper's polynomial, box and settings; "
    "the cheapest point that leaves no more than the paper's own coefficients for the plant, with "
    "two links no more than 1 mm. Boxed gradient: the same polynomial in the same box, at rest on "
    "arrival; gradient: without the box. Robust plan: the same, within 5 % of the plain cycloid's "
    f"residual whatever the frequencies within {_ERROR}. Floor: any joint motion; it starts and "
    "stops with jolts. The move of two links is not of this paper, and its box is this project's."
)


@dataclass(frozen=True)
class _Quantity:
    """A column: its heading and its name in CSV, how its numbers look, and its value."""

    heading: str
    key: str
    form: Callable[[float], str]
    of: Callable[[System], Cell]

    @property
    def column(self) -> Column:
        return Column(self.heading, self.form, self.key)


def seconds_in_words(seconds: float) -> str:
    """Four characters at most: in a terminal of 80 there is room for no more."""
    decimals = 2 if seconds < 0.995 else 1 if seconds < 9.95 else 0
    return f"{seconds:.{decimals}f}"


def _three_digits(value: float) -> str:
    """Three digits at least, never a power of ten: the floor's jolts are as large as 1e5."""
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def _in_millimetres(length: float | None) -> float | None:
    return None if length is None else 1e3 * length


_QUANTITIES = (
    _Quantity("size", "parameters", str, lambda found: found.parameters),
    _Quantity("energy [J]", "energy_J", "{:.4f}".format, lambda found: found.energy),
    _Quantity(
        "residual [mm]", "residual_mm", "{:.2f}".format,
        lambda found: _in_millimetres(found.motion and found.motion.residual),
    ),
    _Quantity(
        f"{_ERROR} off [mm]", "residual_frequency_wrong_mm", "{:.2f}".format,
        lambda found: _in_millimetres(found.wrong_residual),
    ),
    _Quantity(
        "peak torque [N m]", "peak_torque_Nm", _three_digits,
        lambda found: found.motion and found.motion.peak_torque,
    ),
    _Quantity(
        "peak accel. [1/s^2]", "peak_acceleration_rad_s2", _three_digits,
        lambda found: found.motion and found.motion.peak_acceleration,
    ),
    _Quantity("time [s]", "seconds", seconds_in_words, lambda found: found.seconds),
)  # fmt: skip


def systems_table(case: Case, systems: Sequence[System]) -> Table:
    """All systems on one move, a line each where it is shown."""
    columns = [quantity.column for quantity in _QUANTITIES]
    rows: list[list[Cell]] = [
        [found.name, *(c.text(q.of(found)) for c, q in zip(columns, _QUANTITIES, strict=True))]
        for found in systems
    ]
    return Table(f"Side by side: {case.name}", [Column("system"), *columns], rows).turned()


def all_systems(systems: Systems) -> Table:
    """Every system on every move, for CSV."""
    columns = [Column(name, key=name) for name in ("plant", "move", "system")]
    columns += [quantity.column for quantity in _QUANTITIES]
    rows: list[list[Cell]] = [
        [
            case.task.plant.name, case.label, found.name,
            *(quantity.of(found) for quantity in _QUANTITIES), found.why or None,
        ]
        for case, every in systems.items()
        for found in every
    ]  # fmt: skip
    return Table("Side by side", [*columns, Column("why", key="why")], rows)


def systems_blocks(systems: Systems) -> list[Block]:
    """A table for each move, what is missing below it, and how to read them."""
    blocks: list[Block] = []
    for case, every in systems.items():
        missing = [f"{found.name}: {found.why}" for found in every if found.why]
        blocks += [systems_table(case, every), Bullets(missing, soft=True)]
    return [*blocks, Text(LEGEND, soft=True)]
