"""The systems as tables: one for each move on the screen, everything in CSV."""

import csv
import io
from pathlib import Path

import pytest
from quietarm.studies.report.document import Document
from quietarm.studies.report.markdown import markdown, table_in_markdown
from quietarm.studies.reproduction.side_by_side.table import (
    all_systems,
    systems_blocks,
    systems_table,
)

WHOLE = ("plain cycloid", "ZV", "ZVD", "EI", "paper", "boxed gradient", "gradient")
"""Systems that are not cut short in these tests."""


def missing(systems):
    return [f"{found.name}: {found.why}" for found in systems if found.why]


PAGES = Path(__file__).parents[4]


def test_csv_holds_everything_with_every_digit(reproduction):
    rows = list(csv.DictReader(io.StringIO(all_systems(reproduction.systems).csv())))
    every = [(case, one) for case, systems in reproduction.systems.items() for one in systems]
    assert len(rows) == len(every) == 7 * 14
    for row, (case, found) in zip(rows, every, strict=True):
        assert (row["plant"], row["move"]) == (case.task.plant.name, case.label)
        assert (row["system"], row["why"]) == (found.name, found.why)
        motion = found.motion
        for name, value in (
            ("parameters", found.parameters),
            ("energy_J", found.energy),
            ("residual_mm", motion and motion.residual * 1e3),
            ("residual_frequency_wrong_mm", motion and found.wrong_residual * 1e3),
            ("peak_torque_Nm", motion and motion.peak_torque),
            ("peak_acceleration_rad_s2", motion and motion.peak_acceleration),
            ("seconds", found.seconds),
        ):
            assert (float(row[name]) if row[name] else None) == value


def test_markdown_has_a_table_for_each_move_and_what_is_missing(reproduction):
    text = markdown(Document("", systems_blocks(reproduction.systems)))
    for case, systems in reproduction.systems.items():
        assert table_in_markdown(systems_table(case, systems)) in text
        for why in missing(systems):
            assert f"\n- {why}\n" in text


def test_the_page_of_systems_shows_what_is_computed(reproduction):
    page = (PAGES / "docs" / "systems.md").read_text()
    parts = {part.split("\n", 1)[0]: part for part in page.split("\n## ")[1:]}
    assert list(parts) == [case.name for case in reproduction.systems]
    for case, systems in reproduction.systems.items():
        table = systems_table(case, systems)
        heading, _, *lines = table_in_markdown(table).split("\n\n")[1].splitlines()
        assert heading in parts[case.name]
        for line in lines:
            name, *_ = cells = [cell.strip() for cell in line.split("|")[1:-1]]
            (shown,) = [one for one in parts[case.name].splitlines() if f"| {name} |" in one]
            if name in WHOLE:  # without the time; the last digits are another machine's
                for mine, theirs in zip(cells[1:-1], shown.split("|")[2:-2], strict=True):
                    assert theirs.strip() == mine or float(theirs) == pytest.approx(
                        float(mine), rel=0.01, abs=0.011
                    )
        assert all(f"- {why}\n" in page for why in missing(systems) if why.split(":")[0] in WHOLE)
