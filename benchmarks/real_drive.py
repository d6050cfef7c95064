"""Replay plans on a real drive: servo, backlash, dead time, tool, encoder, dry friction.

    pip install ".[benchmark]"
    python benchmarks/real_drive.py [--machine gantry picker] [--output real_drive.csv]
    python benchmarks/real_drive.py --page
    python benchmarks/real_drive.py --recordings

The machines are not quietarm's model (`parts/drive`). Each is recorded as a user records it, then
planned for by quietarm with what it identifies, and its set points are replayed at 1 kHz on
machines that differ in one property at a time. The csv has a row for every run. `--page` writes the
pages docs/drive*.md from the csv; without it the csv is made anew, too. `--recordings` writes
the recordings that the pages use, of a tool that swings while its axis moves.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from parts.drive import page, recordings
from parts.drive.machines import Machine
from parts.drive.measures import Outcome, outcomes
from parts.drive.moves import MOVES, Move, plan, shaper_over_ruckig
from parts.drive.recordings import WAYS, identified
from parts.drive.simulate import SetPoints, simulate
from parts.measuring import console, machine, timed

BAND = 1e-4
"""Distance from the target within which the tool may act [m]."""
LIMIT = 3e-5
"""Residual limit of the robust plans [m], but for those of the margins."""
RANGE = 0.05
"""Error of the frequency for which robust plans are made."""
WIDER = 0.1
"""That of the other robust plan."""
MARGINS = (1, 2, 3, 5)
"""Bands over residual limits."""
BANDS = (5e-5, 1e-4, 2e-4, 5e-4)
"""Bands of the margins [m]."""
ERRORS = (0.0, 0.02, -0.02, 0.05, -0.05, 0.1, -0.1)
"""Errors of the structure's frequencies."""
WITHIN = tuple(error for error in ERRORS if abs(error) <= RANGE)
"""Those within the range of the robust plans."""
BEST = "on the way"
"""The way to record that gives the frequency, but for the study of ways."""
RECORDINGS = Path(__file__).parents[1] / "docs" / "recordings"
"""The recordings that the pages use."""
AT_ONCE = 300
"""Runs that are simulated side by side."""

Vary = Callable[[Machine, float], Machine]
Tell = Callable[[str], None]


def _with_bandwidth(m: Machine, hertz: float) -> Machine:
    return replace(m, servo=m.servo.with_bandwidth(hertz))


def _with_delay(m: Machine, ticks: float) -> Machine:
    return replace(m, servo=replace(m.servo, delay=int(ticks)))


def _with_quantum(m: Machine, quantum: float) -> Machine:
    return replace(m, servo=replace(m.servo, quantum=quantum))


def _with_dry_friction(m: Machine, factor: float) -> Machine:
    motor = m.motor_friction.times(factor)
    return replace(m, motor_friction=motor, guide_friction=m.guide_friction.times(factor))


DRIVES: dict[str, tuple[Vary, tuple[float, ...]]] = {
    "servo": (_with_bandwidth, (150, 60, 40, 20)),
    "backlash": (lambda m, play: replace(m, backlash=play), (0, 1e-5, 5e-5, 2e-4)),
    "dead time": (_with_delay, (1, 2, 4, 8)),
    "encoder": (_with_quantum, (1e-6, 2e-6, 1e-5, 5e-5)),
    "friction": (_with_dry_friction, (0, 0.5, 1, 2, 4)),
}
"""Properties of the drive: how they are varied, and their values."""
STRUCTURES: dict[str, tuple[Vary, tuple[float, ...]]] = {
    "frequency": (lambda m, error: replace(m, frequency_error=error), ERRORS),
    "tool": (lambda m, factor: replace(m, tool=factor), (0.8, 0.9, 1, 1.1, 1.2)),
}
"""Properties of what the drive moves."""


@dataclass(frozen=True)
class Model:
    """Model of the structure by a recording: the way, frequency [Hz], damping and swing [m]."""

    way: str
    frequency: float
    damping: float
    swing: float

    @classmethod
    def recorded(cls, way: str, move: Move, actual: Machine) -> Model:
        """Identify a machine from its recording."""
        return cls(way, *identified(way, move, actual))


@dataclass(frozen=True)
class Case:
    """A run to make."""

    study: str
    value: str
    model: Model
    motion: str
    machine: Machine
    asked: SetPoints
    limit: float | None = None
    band: float = BAND

    def row(self, found: Outcome) -> list[str]:
        """Return the case's row of the csv."""
        return [
            self.machine.name,
            self.study,
            self.value,
            self.model.way,
            f"{self.model.frequency:.4f}",
            f"{self.model.damping:.5f}",
            f"{1e3 * self.model.swing:.2f}",
            self.motion,
            "" if self.limit is None else f"{1e3 * self.limit:.4g}",
            f"{self.machine.frequency_error:g}",
            f"{1e3 * self.band:g}",
            f"{self.asked.duration:.3f}",
            f"{found.acts_after:.3f}",
            *(f"{1e3 * length:.3g}" for length in (found.residual, found.farthest)),
            f"{1e3 * found.following:.3g}",
            f"{found.peak_force:.4g}",
            f"{found.energy:.4g}",
        ]


COLUMNS = (
    "machine", "study", "value", "recorded", "frequency_hz", "damping", "swing_mm", "motion",
    "limit_mm", "error", "band_mm", "duration_s", "acts_after_s", "residual_mm", "farthest_mm",
    "following_mm", "peak_force_n", "energy_j",
)  # fmt: skip
"""Columns of the csv; `acts_after_s` is inf if the tool never stays within the band."""


class Campaign:
    """All runs of one machine; plans are made once."""

    def __init__(self, move: Move, tell: Tell) -> None:
        self.move = move
        self._tell = tell
        self._plans = dict[tuple[Model, float, float, float | None], SetPoints]()
        self.model = self.record(BEST, move.machine)
        self.duration = move.shortest("zvd", self.model.frequency, self.model.damping)
        tell(f"all but one motion take {self.duration:.3f} s")

    def record(self, way: str, actual: Machine) -> Model:
        """Identify a machine, and say what was found."""
        model = Model.recorded(way, self.move, actual)
        self._tell(
            f"{self.move.machine.name} with a servo of {actual.servo.speed_loop:g} Hz, recorded "
            f"{way}: {model.frequency:.4f} Hz, damping {model.damping:.5f}"
        )
        return model

    def plan(
        self, model: Model, duration: float, error: float = 0.0, limit: float | None = None
    ) -> SetPoints:
        """Set points of a plan with a model; each plan is made once."""
        key = (model, duration, error, limit)
        if key not in self._plans:
            task = self.move.task(model.frequency, model.damping, duration, error)
            self._plans[key] = plan(task, limit)
        return self._plans[key]

    def robust(self, model: Model, limit: float = LIMIT) -> SetPoints:
        """The robust plan of the common duration."""
        return self.plan(model, self.duration, RANGE, limit)

    def cases(self) -> Iterator[Case]:
        """All of them, study by study."""
        yield from self.one_property_at_a_time()
        yield from self.servos_recorded_anew()
        yield from self.ways_to_record()
        yield from self.margins()
        yield from self.margins_on_every_drive()

    def motions(self) -> dict[str, tuple[SetPoints, float | None]]:
        """The motions that are compared, with their residual limits."""
        model = self.model
        task = self.move.task(model.frequency, model.damping, self.duration)
        return {
            "nominal": (self.plan(model, self.duration), None),
            "robust": (self.robust(model), LIMIT),
            "robust, sooner": (self.plan(model, self.move.sooner, RANGE, LIMIT), LIMIT),
            "robust to 10 %": (self.plan(model, self.duration, WIDER, LIMIT), LIMIT),
            "ZV": (shaper_over_ruckig(task, "zv"), None),
            "ZVD": (shaper_over_ruckig(task, "zvd"), None),
        }

    def drives(self) -> list[tuple[str, float, Machine]]:
        """Machines with another drive: property, value, machine."""
        return [
            (study, value, vary(self.move.machine, value))
            for study, (vary, values) in DRIVES.items()
            for value in values
            if study != "backlash" or self.move.machine.belt is not None
        ]

    def one_property_at_a_time(self) -> Iterator[Case]:
        """Every motion on every machine."""
        machines = self.drives()
        for study, (vary, values) in STRUCTURES.items():
            machines += [(study, value, vary(self.move.machine, value)) for value in values]
        for study, value, varied in machines:
            for name, (asked, limit) in self.motions().items():
                yield Case(study, f"{value:g}", self.model, name, varied, asked, limit)

    def servos_recorded_anew(self) -> Iterator[Case]:
        """Plans for each servo, recorded under that servo."""
        vary, values = DRIVES["servo"]
        for hertz in values:
            varied = vary(self.move.machine, hertz)
            model = self.record(BEST, varied)
            nominal = self.plan(model, self.duration)
            study, value = "servo, recorded anew", f"{hertz:g}"
            yield Case(study, value, model, "nominal", varied, nominal)
            yield Case(study, value, model, "robust", varied, self.robust(model), LIMIT)

    def ways_to_record(self) -> Iterator[Case]:
        """Plans with what each way to record identifies."""
        for way in WAYS:
            model = self.record(way, self.move.machine)
            nominal = self.plan(model, self.duration)
            yield Case("recording", way, model, "nominal", self.move.machine, nominal)
            for varied in self.with_errors(self.move.machine):
                robust = self.robust(model)
                yield Case("recording", way, model, "robust", varied, robust, LIMIT)

    def with_errors(self, actual: Machine) -> list[Machine]:
        """A machine with every error of the robust plans' range."""
        return [replace(actual, frequency_error=error) for error in WITHIN]

    def margins(self) -> Iterator[Case]:
        """Robust plans whose limit is a band over a margin, for bands and ways to record."""
        held = self.record("brake", self.move.machine)
        for model in (self.model, held):
            for band in BANDS:
                for margin in MARGINS:
                    limit = band / margin
                    asked = self.robust(model, limit)
                    for varied in self.with_errors(self.move.machine):
                        yield Case(
                            "margin", f"{margin}", model, "robust", varied, asked, limit, band
                        )

    def margins_on_every_drive(self) -> Iterator[Case]:
        """Yield cases of one band, and of ZVD, on machines with another drive."""
        zvd, _ = self.motions()["ZVD"]
        different = dict[Machine, str]()
        for study, value, drive in self.drives():
            different.setdefault(drive, f"{study} {value:g}")
        for drive, name in different.items():
            for varied in self.with_errors(drive):
                yield Case("every drive", name, self.model, "ZVD", varied, zvd)
                for margin in MARGINS:
                    limit = BAND / margin
                    asked = self.robust(self.model, limit)
                    yield Case("every drive", name, self.model, "robust", varied, asked, limit)


def batches(cases: list[Case]) -> Iterator[list[Case]]:
    """As many cases as are simulated side by side; 300 take half a gigabyte."""
    for first in range(0, len(cases), AT_ONCE):
        yield cases[first : first + AT_ONCE]


def rows_of(cases: list[Case]) -> list[list[str]]:
    """Rows of the csv: the cases and what they come to."""
    rows = list[list[str]]()
    for together in batches(cases):
        machines = [case.machine for case in together]
        asked = [case.asked for case in together]
        runs = simulate(machines, asked)
        found = outcomes(runs, machines, asked, [case.band for case in together])
        rows += [case.row(outcome) for case, outcome in zip(together, found)]
    return rows


def main() -> None:
    """Record, plan, replay, and write the csv and the pages."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--machine", nargs="+", choices=MOVES, default=list(MOVES))
    parser.add_argument("--output", type=Path, default=page.RESULTS, help="csv to write")
    parser.add_argument("--page", action="store_true", help="only write the pages from the csv")
    parser.add_argument("--recordings", action="store_true", help="only write docs/recordings")
    options = parser.parse_args()
    out = console()
    if options.recordings:
        for name in options.machine:
            recordings.save(BEST, MOVES[name], MOVES[name].machine, RECORDINGS / f"{name}.csv")
            out.print(f"wrote {RECORDINGS / name}.csv")
        return
    if not options.page:
        out.print(machine())
        table = list[list[str]]()
        for name in options.machine:
            seconds, cases = timed(lambda name=name: list(Campaign(MOVES[name], out.print).cases()))
            out.print(f"recorded and planned in {seconds:.0f} s")
            seconds, rows = timed(lambda cases=cases: rows_of(cases))
            out.print(f"{len(cases)} runs in {seconds:.0f} s")
            table += rows
        with options.output.open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([COLUMNS, *table])
        out.print(f"wrote {options.output}")
    if options.output == page.RESULTS and options.machine == list(MOVES):
        page.write()
        out.print("wrote", *(f"docs/{name}.md" for name in page.PAGES))


if __name__ == "__main__":
    main()
