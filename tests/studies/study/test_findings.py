"""What the headline study says in words."""

import re

import pytest
from quietarm.studies.study.findings import case_findings
from small_study import FLOOR

# What it says


def test_findings_are_those_of_the_fronts(small):
    found = small.cases[0]
    words = " ".join(case_findings(found))
    fronts = {run.front.method: run.front for run in found.comparison.runs}
    best = found.comparison.best[1]
    assert f"within 1 mm is {best:.4g} J" in words
    # at least as good as what every front holds
    assert best <= min(front.cheapest(1e-3).energy for front in fronts.values()
                       if front.stillest().residual <= 1e-3)  # fmt: skip
    # docs/physics.md: the printed coefficients for N = 2 take 0.06297 J with 0.256 mm
    (claim,) = re.findall(r"N = 2, takes 0.06297 J at 0.256 mm: (\S+) % more", words)
    at_paper = min(front.cheapest(2.56e-4).energy for front in fronts.values()
                   if front.stillest().residual <= 2.56e-4)  # fmt: skip
    assert float(claim) == pytest.approx(100 * (0.06297 / at_paper - 1), abs=0.6)
    ratio = fronts["epsilon"].stillest().energy / FLOOR.energy
    assert f"{ratio:.3g} times the floor" in words
