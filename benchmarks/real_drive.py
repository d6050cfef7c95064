"""What a real drive leaves of a plan: servo, backlash, dead time, tool, encoder, dry friction.

    pip install ".[benchmark]"
    python benchmarks/real_drive.py [--machine gantry picker] [--output real_drive.csv]
    python benchmarks/real_drive.py --page

The machines are not quietarm's model (`parts/drive`). Each is recorded as a user records it, then
planned for by quietarm with what it identifies, and its set points are replayed at 1 kHz on
machines that differ in one property at a time. `--page` writes the tables of docs/drive.md from the
csv; without it all is made anew, and the page as well if all machines are.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Callable, Iterator
from dataclasses import astuple, dataclass, fields, replace
from pathlib import Path

from parts.drive import page
from parts.drive.machines import Machine
from parts.drive.measures import Outcome, outcomes
from parts.drive.moves import MOVES, RANGE, Move, plan, shaper_over_ruckig
from parts.drive.recordings import WAYS, identified
from parts.drive.simulate import SetPoints, simulate
from parts.measuring import console, machine, timed

BAND = 1e-4
"""Distance from the target within which the tool may act [m]."""
LIMIT = 3e-5
"""Residual limit of the robust plans of all studies but the one of margins [m]."""
MARGINS = (1, 2, 3, 5)
"""Bands over residual limits."""
BANDS = (5e-5, 1e-4, 2e-4, 5e-4)
ERRORS = (0.0, 0.02, -0.02, 0.05, -0.05, 0.1, -0.1)
"""Errors of the structure's frequencies."""
WITHIN = tuple(error for error in ERRORS if abs(error) <= RANGE)
"""Those for which robust plans are made."""
BANDWIDTHS = (150.0, 60.0, 40.0, 20.0)
"""Speed loops [Hz]."""
BEST = "on the way"
"""The way to record that gives the frequency of all studies but the one of ways."""

Vary = Callable[[Machine, float], Machine]


def _servo(**changes: str) -> Vary:
    (name,) = changes
    kind = {"int": int, "float": float}[changes[name]]
    return lambda m, value: replace(m, servo=replace(m.servo, **{name: kind(value)}))


def _dry(m: Machine, factor: float) -> Machine:
    return replace(
        m,
        motor_friction=m.motor_friction.times(factor),
        guide_friction=m.guide_friction.times(factor),
    )


STUDIES: dict[str, tuple[Vary, tuple[float, ...]]] = {
    "frequency": (lambda m, error: replace(m, frequency_error=error), ERRORS),
    "servo": (lambda m, hertz: replace(m, servo=m.servo.with_bandwidth(hertz)), BANDWIDTHS),
    "backlash": (lambda m, play: replace(m, backlash=play), (0.0, 1e-5, 5e-5, 2e-4)),
    "dead time": (_servo(delay="int"), (1, 2, 4, 8)),
    "tool": (lambda m, factor: replace(m, tool=factor), (1.0, 0.9, 1.1, 0.8, 1.2)),
    "encoder": (_servo(quantum="float"), (1e-6, 2e-6, 1e-5, 5e-5)),
    "friction": (_dry, (0.0, 0.5, 1.0, 2.0, 4.0)),
}
"""Properties that are varied: how, and their values."""


@dataclass(frozen=True)
class Case:
    """A run to make: a row of the table without its outcome."""

    study: str
    value: str
    motion: str
    machine: Machine
    asked: SetPoints
    band: float = BAND
    error: float = 0.0


COLUMNS = (
    "machine", "study", "value", "motion", "error", "band_mm", "duration_s",
    *(field.name for field in fields(Outcome)),
)  # fmt: skip
"""Columns of the csv; lengths of the outcomes in metres."""


def cases_of(move: Move, tell: Callable[[str], None]) -> Iterator[Case]:
    """All runs of a machine, planned for."""
    exact = identified(BEST, move, move.machine)[:2]
    duration = move.shortest("zvd", *exact)
    tell(f"{move.machine.name}: {exact[0]:.4f} Hz, damping {exact[1]:.5f}, {duration:.3f} s")
    motions = {
        "nominal": plan(move.task(*exact, duration)),
        "robust": plan(move.task(*exact, duration, RANGE), LIMIT),
        "robust, sooner": plan(move.task(*exact, move.sooner, RANGE), LIMIT),
        "ZV": shaper_over_ruckig(move.task(*exact, duration), "zv"),
        "ZVD": shaper_over_ruckig(move.task(*exact, duration), "zvd"),
    }
    for study, (vary, values) in STUDIES.items():
        if study == "backlash" and move.machine.belt is None:
            continue
        for value in values:
            varied = vary(move.machine, value)
            for name, asked in motions.items():
                yield Case(study, f"{value:g}", name, varied, asked)
    yield from recorded_anew(move, duration, tell)
    yield from recorded_otherwise(move, duration, tell)
    yield from margins(move, exact, duration)


def recorded_anew(move: Move, duration: float, tell: Callable[[str], None]) -> Iterator[Case]:
    """Plans for each servo, recorded under that servo."""
    for hertz in BANDWIDTHS:
        varied = replace(move.machine, servo=move.machine.servo.with_bandwidth(hertz))
        frequency, damping, _ = identified(BEST, move, varied)
        tell(f"servo {hertz:g} Hz: {frequency:.4f} Hz, damping {damping:.5f}")
        value = f"{hertz:g}"
        nominal = plan(move.task(frequency, damping, duration))
        robust = plan(move.task(frequency, damping, duration, RANGE), LIMIT)
        yield Case("servo, recorded anew", value, "nominal", varied, nominal)
        yield Case("servo, recorded anew", value, "robust", varied, robust)


def recorded_otherwise(move: Move, duration: float, tell: Callable[[str], None]) -> Iterator[Case]:
    """Plans with the frequency and damping of each way to record; the value has these."""
    for way in WAYS:
        frequency, damping, swing = identified(way, move, move.machine)
        tell(f"{way}: {frequency:.4f} Hz, damping {damping:.5f}, swing {1e3 * swing:.2f} mm")
        value = f"{way}; {frequency:.4f} Hz; {damping:.5f}; {1e3 * swing:.2f} mm"
        nominal = plan(move.task(frequency, damping, duration))
        robust = plan(move.task(frequency, damping, duration, RANGE), LIMIT)
        yield Case("recording", value, "nominal", move.machine, nominal)
        for error in WITHIN:
            varied = replace(move.machine, frequency_error=error)
            yield Case("recording", value, "robust", varied, robust, error=error)


def margins(move: Move, exact: tuple[float, float], duration: float) -> Iterator[Case]:
    """Robust plans whose limit is a band over a margin, at all errors of their range."""
    brake = identified("brake", move, move.machine)[:2]
    for way, model in ((BEST, exact), ("brake", brake)):
        for band in BANDS:
            for margin in MARGINS:
                asked = plan(move.task(*model, duration, RANGE), band / margin)
                for error in WITHIN:
                    varied = replace(move.machine, frequency_error=error)
                    yield Case(f"margin, {way}", f"{margin}", "robust", varied, asked, band, error)


def rows_of(cases: list[Case]) -> list[list[str]]:
    """Rows of the csv: the cases and what they come to."""
    machines = [case.machine for case in cases]
    asked = [case.asked for case in cases]
    runs = simulate(machines, asked)
    found = outcomes(runs, machines, asked, [case.band for case in cases])
    return [
        [
            case.machine.name, case.study, case.value, case.motion, f"{case.error:g}",
            f"{1e3 * case.band:g}", f"{case.asked.duration:.3f}",
            *(f"{number:.4g}" for number in astuple(outcome)),
        ]
        for case, outcome in zip(cases, found)
    ]  # fmt: skip


def main() -> None:
    """Record, plan, replay, and write the csv and the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--machine", nargs="+", choices=MOVES, default=list(MOVES))
    parser.add_argument("--output", type=Path, default=page.RESULTS, help="csv to write")
    parser.add_argument("--page", action="store_true", help="only write the page from the csv")
    options = parser.parse_args()
    if not options.page:
        out = console()
        out.print(machine())
        table = list[list[str]]()
        for name in options.machine:
            seconds, cases = timed(lambda name=name: list(cases_of(MOVES[name], out.print)))
            out.print(f"recorded and planned in {seconds:.0f} s")
            seconds, rows = timed(lambda cases=cases: rows_of(cases))
            out.print(f"{len(cases)} runs in {seconds:.0f} s")
            table += rows
        with options.output.open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([COLUMNS, *table])
        out.print(f"wrote {options.output}")
    if options.output == page.RESULTS and set(options.machine) == set(MOVES):
        page.write()


if __name__ == "__main__":
    main()
