"""The runs of a contest for the tools of others."""

import csv
from pathlib import Path

import numpy as np
import pytest
from quietarm.studies.contest.measures import arenas_of, quartiles
from quietarm.studies.contest.store import Store
from small_contest import LINE


def test_runs_are_written_for_iohanalyzer_and_coco(call, copy, no_pictures):
    code, _, err = call(f"{LINE} --output held --ioh runs.csv --coco archive --report results")
    assert (code, err) == (0, "")
    arenas = arenas_of(Store(copy))
    rows = [*csv.DictReader(Path("runs.csv").read_text().splitlines())]
    field = arenas[0].fields[0]
    own = [row for row in rows if (row["function"], row["algorithm"], row["run"])
           == (arenas[0].problem, field.method, "1")]  # fmt: skip
    assert [int(row["evaluations"]) for row in own] == field.evaluations.tolist()
    assert [float(row["missing"]) for row in own] == pytest.approx(field.missing[0].tolist())

    files = sorted(Path("archive").glob("quietarm_f*_nondominated.adat"))
    assert len(files) == len(arenas)
    for file in files:
        table = np.loadtxt(file, comments="%")
        assert (table[:2, 0] == 0).all()  # extremes
        found = table[2:, 1:3]
        order = np.argsort(found[:, 0])
        assert (np.diff(found[order, 1]) < 0).all()  # none dominates another

    # what is missing after a tenth, three tenths and all of the evaluations, of every method
    report = Path("results/report.md").read_text()
    assert "--report results` makes this page anew" in report
    assert "| method | after 13 [%] | after 39 [%] | after 130 [%] |" in report
    for field in arenas[0].fields:
        lower, median, upper = 100 * quartiles(field.final)
        (row,) = [line for line in report.splitlines() if line.startswith(f"| {field.label} | 100")]
        assert row.endswith(f"| {median:.3g} ({lower:.3g} to {upper:.3g}) |")
