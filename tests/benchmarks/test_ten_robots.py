"""Tables of benchmarks/ten_robots.py: the page of evidence has those of the results as they are."""

import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "benchmarks"))
RESULTS = ROOT / "benchmarks" / "results" / "ten_robots.csv"


def test_the_page_has_the_tables_of_the_results():
    from parts.robots_table import with_tables

    page = (ROOT / "docs" / "robots_evidence.md").read_text(encoding="utf-8")

    assert with_tables(page, RESULTS) == page


def test_a_plan_for_every_robot_keeps_its_limits_and_leaves_a_twentieth_of_a_millimetre():
    from parts.robots_table import IN_FULL, PLAN, passes_limit, read

    for name, motions in read(RESULTS).items():
        best = motions.get(IN_FULL, motions[PLAN])
        assert float(best["residual_mm"]) < 0.05, name  # in MuJoCo, as robots_evidence.md says
        assert not passes_limit(best), name
