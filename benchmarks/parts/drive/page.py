"""Write the pages of the real drive from the csv: tables, and the figures of sentences."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import jinja2

ROOT = Path(__file__).parents[3]
RESULTS = ROOT / "benchmarks" / "results" / "real_drive.csv"
TEMPLATES = Path(__file__).with_name("pages")
PAGES = {place.stem: ROOT / "docs" / place.name for place in sorted(TEMPLATES.glob("*.md"))}
"""Pages of docs that are written from the csv, each from the template of its name."""
MACHINES = ("gantry", "picker")
LARGEST = {"gantry": 900.0, "picker": 180.0}
"""Forces at which the drives saturate [N]."""
MOTIONS = ("nominal", "robust", "robust, sooner", "robust to 10 %", "ZV", "ZVD")
NAMES = {
    "nominal": "plan without an error",
    "robust": "robust plan, 5 %",
    "robust, sooner": "robust plan, 5 %, shorter",
    "robust to 10 %": "robust plan, 10 %",
    "ZV": "ZV over ruckig",
    "ZVD": "ZVD over ruckig",
}
"""What the page calls the motions."""
WAYS = {
    "brake": "a push on the motor's brake",
    "light push": "a light push, the servo holds the axis",
    "hard push": "a hard push, the servo holds the axis",
    "after a hard move": "after the fastest move, without a shaper",
    "on the way": "while the axis moves at 0.1 m/s",
}
"""What the page calls the ways to record."""
ERRORS = ("0", "0.02", "0.05", "0.1")
PROPERTIES = {
    "servo": ("a speed loop of {} Hz", 1.0),
    "servo, recorded anew": ("the same, recorded under it: {} Hz", 1.0),
    "backlash": ("a backlash of {} um", 1e6),
    "dead time": ("a dead time of {} ms", 0.25),
    "encoder": ("an encoder step of {} um", 1e6),
    "friction": ("{} times the dry friction", 1.0),
    "tool": ("{} times the tool's mass", 1.0),
}
"""What the page calls the properties, and their unit over that of the csv."""


@dataclass(frozen=True)
class Row:
    """A row of the csv, its numbers as numbers."""

    machine: str
    study: str
    value: str
    recorded: str
    frequency_hz: float
    damping: float
    swing_mm: float
    motion: str
    limit_mm: float | None
    error: float
    band_mm: float
    duration_s: float
    acts_after_s: float
    residual_mm: float
    farthest_mm: float
    following_mm: float
    peak_force_n: float
    energy_j: float

    @classmethod
    def read(cls, words: dict[str, str]) -> Row:
        """A row from its words."""
        texts = {"machine", "study", "value", "recorded", "motion"}
        return cls(**{
            name: word if name in texts else float(word) if word else None
            for name, word in words.items()
        })  # fmt: skip

    @property
    def stays(self) -> bool:
        """Return whether the tool stays within the band from the end of the command on."""
        return self.farthest_mm <= self.band_mm


class Runs:
    """All rows of the csv, and what the page asks of them."""

    def __init__(self, path: Path = RESULTS) -> None:
        with path.open(newline="") as file:
            self.rows = [Row.read(words) for words in csv.DictReader(file)]

    def where(self, **values) -> list[Row]:
        """Rows with these values."""
        return [
            row
            for row in self.rows
            if all(getattr(row, name) == value for name, value in values.items())
        ]

    def one(self, **values) -> Row:
        """The first row with these values."""
        return self.where(**values)[0]

    def base(self, machine: str, motion: str) -> Row:
        """The run of a motion on the machine as it was recorded."""
        return self.one(machine=machine, study="frequency", value="0", motion=motion)

    def off(self, machine: str, motion: str, size: str) -> list[Row]:
        """The runs with an error of the frequency, of both signs."""
        found = self.where(machine=machine, study="frequency", motion=motion)
        return [row for row in found if row.value in {size, f"-{size}"}]

    def acts(self, machine: str, motion: str, size: str = "0") -> str:
        """When the tool may act, the later of both signs [s], or `never`."""
        return acts(max(row.acts_after_s for row in self.off(machine, motion, size)))

    def left(self, machine: str, motion: str, size: str = "0") -> str:
        """Say how far the tool is off its target after a command, the worse of both signs [mm]."""
        return length(max(row.farthest_mm for row in self.off(machine, motion, size)))

    def worst(self, way: str, machine: str, motion: str) -> str:
        """Distance from the target with the model of a way to record, at all errors run [mm]."""
        rows = self.where(study="recording", value=way, machine=machine, motion=motion)
        return length(max(row.farthest_mm for row in rows))

    def on(self, machine: str, study: str, value: str, motion: str) -> str:
        """Distance from the target on a machine with another property [mm]."""
        row = self.one(machine=machine, study=study, value=value, motion=motion)
        return length(row.farthest_mm)

    def acts_on(self, machine: str, study: str, value: str, motion: str) -> str:
        """When the tool may act on a machine with another property [s], or `never`."""
        return acts(self.one(machine=machine, study=study, value=value, motion=motion).acts_after_s)

    def used(self, machine: str, way: str, band: float, margin: int) -> float:
        """Share of a band that the tool uses after the command, at its worst error."""
        rows = self.where(
            machine=machine, study="margin", recorded=way, band_mm=band, value=f"{margin}"
        )
        return max(row.farthest_mm for row in rows) / band

    def hunts(self, machine: str, study: str, value: str) -> bool:
        """Return whether a servo shakes its axis with its largest force, whatever the motion."""
        rows = self.where(machine=machine, study=study, value=value)
        return all(row.peak_force_n >= LARGEST[machine] for row in rows)

    def drives(self, machine: str) -> list[str]:
        """The drives on which the margins were tried, without those that hunt."""
        rows = self.where(machine=machine, study="every drive")
        return [
            drive
            for drive in dict.fromkeys(row.value for row in rows)
            if not self.hunts(machine, "every drive", drive)
        ]

    def quiet(self, machine: str, margin: int | None) -> list[str]:
        """Drives whose tool stays within the band at every error; without a margin by ZVD."""
        found = list[str]()
        for drive in self.drives(machine):
            rows = self.where(machine=machine, study="every drive", value=drive)
            limit = None if margin is None else float(f"{0.1 / margin:.4g}")
            if all(row.stays for row in rows if row.limit_mm == limit):
                found.append(drive)
        return found

    def added(self) -> str:
        """Say what the drives add to residual limits of 0.1 mm over 2, 3 and 5, as a range [mm]."""
        found = [
            0.1 * self.used(machine, "on the way", 0.1, margin) - 0.1 / margin
            for machine in MACHINES
            for margin in (2, 3, 5)
        ]
        return f"{min(found):.3f} to {max(found):.3f} mm"

    def fail_words(self, machine: str) -> str:
        """The drives on which a third of the band is not enough, in words."""
        quiet = self.quiet(machine, 3)
        return listed(described(drive) for drive in self.drives(machine) if drive not in quiet)

    def gained(self) -> str:
        """The drives on which a fifth of the band is enough and a third is not, in words."""
        found = [
            f"{described(drive)} on the {machine}"
            for machine in MACHINES
            for drive in self.quiet(machine, 5)
            if drive not in self.quiet(machine, 3)
        ]
        return listed(found) or "none"

    def shift(self, machine: str) -> str:
        """Say by how much slower a structure swings while its axis moves."""
        moving, standing = (
            self.one(machine=machine, study="recording", value=way).frequency_hz
            for way in ("on the way", "light push")
        )
        return f"{100 * (1 - moving / standing):.1f} %"

    def price(self, machine: str, margin: int) -> str:
        """Energy of a margin over that of none, for a band of 0.1 mm."""
        energies = [
            self.one(
                machine=machine, study="margin", recorded="on the way", band_mm=0.1,
                value=f"{each}", error=0.0,
            ).energy_j
            for each in (margin, 1)
        ]  # fmt: skip
        return percent(energies[0] / energies[1] - 1)

    def table_of_errors(self, machine: str) -> str:
        """Every motion at every error."""
        head = (
            "motion", "takes [s]", "acts after [s] at 0", "2", "5", "10 %",
            "left [mm] at 0", "5 %", "peak [N]", "energy [J]",
        )  # fmt: skip
        rows = list[list[str]]()
        for motion in MOTIONS:
            base = self.base(machine, motion)
            rows.append([
                NAMES[motion],
                f"{base.duration_s:.3f}",
                *(self.acts(machine, motion, size) for size in ERRORS),
                self.left(machine, motion),
                self.left(machine, motion, "0.05"),
                f"{base.peak_force_n:.0f}",
                f"{base.energy_j:.4g}",
            ])  # fmt: skip
        return table(head, rows)

    def table_of_ways(self, machine: str) -> str:
        """Make a table of what each way to record identifies, and what plans leave with it."""
        head = (
            "recorded", "swing [mm]", "frequency [Hz]", "damping", "plan leaves [mm]",
            "robust plan [mm]",
        )  # fmt: skip
        rows = list[list[str]]()
        for way, name in WAYS.items():
            row = self.one(machine=machine, study="recording", value=way)
            rows.append([
                name,
                f"{row.swing_mm:.1f}",
                f"{row.frequency_hz:.3f}",
                f"{row.damping:.4f}",
                self.worst(way, machine, "nominal"),
                self.worst(way, machine, "robust"),
            ])  # fmt: skip
        return table(head, rows)

    def table_of_properties(self, machine: str) -> str:
        """When the tool may act and what is left, for one property at a time."""
        shown = [motion for motion in MOTIONS if motion != "robust to 10 %"]
        rows = list[list[str]]()
        for study, (words, unit) in PROPERTIES.items():
            found = self.where(machine=machine, study=study)
            for value in dict.fromkeys(row.value for row in found):
                by_motion = {row.motion: row for row in found if row.value == value}
                name = words.format(f"{float(value) * unit:.3g}")
                name = name.removeprefix("a ").removeprefix("an ")
                if self.hunts(machine, study, value):
                    name += ", hunts"
                rows.append([name, *(cell(by_motion.get(motion)) for motion in shown)])
        return table(("property", *(NAMES[motion] for motion in shown)), rows)

    def table_of_margins(self) -> str:
        """Shares of a band that the tool uses with limits of the band over margins."""
        head = ("machine, recorded", "band [mm]", "limit: band", "band / 2", "band / 3", "band / 5")
        rows = list[list[str]]()
        for machine in MACHINES:
            for way in ("on the way", "brake"):
                for band in (0.05, 0.1, 0.2, 0.5):
                    shares = [self.used(machine, way, band, margin) for margin in (1, 2, 3, 5)]
                    rows.append([f"{machine}, {way}", f"{band:g}", *map(percent, shares)])
        return table(head, rows)

    def table_of_drives(self) -> str:
        """On how many drives the tool stays within the band at every error."""
        head = ("machine", "calm drives", "limit: band", "band / 2", "band / 3", "band / 5", "ZVD")
        rows = list[list[str]]()
        for machine in MACHINES:
            counts = [len(self.quiet(machine, margin)) for margin in (1, 2, 3, 5, None)]
            rows.append([machine, f"{len(self.drives(machine))}", *map(str, counts)])
        return table(head, rows)


def acts(seconds: float) -> str:
    """When the tool may act, as the page writes it."""
    return "never" if seconds == float("inf") else f"{seconds:.3f}"


def length(millimetres: float) -> str:
    """A length [mm] with two digits, and not more than three after the point."""
    return f"{millimetres:.3f}" if millimetres < 0.1 else f"{millimetres:.2g}"


def percent(share: float) -> str:
    """A share with its sign."""
    return f"{100 * share:.0f} %"


def described(drive: str) -> str:
    """A drive as the page calls it, of a property and its value."""
    study, value = drive.rsplit(" ", 1)
    words, unit = PROPERTIES[study]
    return words.format(f"{float(value) * unit:.3g}")


def listed(words: Iterable[str]) -> str:
    """Words with commas, the last with `and`."""
    *others, last = [*words] or [""]
    return f"{', '.join(others)} and {last}" if others else last


def cell(row: Row | None) -> str:
    """When the tool may act and how far it is from its target."""
    return "" if row is None else f"{acts(row.acts_after_s)}; {length(row.farthest_mm)}"


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A table in Markdown, all columns but the first to the right."""
    head = list(head)
    lines = [head, ["---", *["---:"] * (len(head) - 1)], *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def written(name: str, path: Path = RESULTS) -> str:
    """Return the text of one of `PAGES`, from the csv."""
    template = jinja2.Template(
        (TEMPLATES / f"{name}.md").read_text(),
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
    )
    return template.render(runs=Runs(path), percent=percent, length=length, acts=acts)


def write() -> None:
    """Write the pages."""
    for name, place in PAGES.items():
        place.write_text(written(name))
