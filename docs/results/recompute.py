"""Every figure of report.md from the files beside it, with moocore, scipy and numpy, not quietarm.

    python recompute.py            compares them with figures.json, and the pages with the figures
    python recompute.py --write    writes figures.json

report.md and appendix.md are filled in from figures.json by templates of the repository, which need
quietarm for the names of methods: without it the figures alone are compared. What the files hold is
in appendix.md, under "Files". `compute` names the figures as figures.json does; the file in
`recomputing` that computes one is that from which its function is imported.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).parent))
from recomputing.arms import arm_figures
from recomputing.attained_targets import attained_figures, runtime_profiles
from recomputing.basins import basins_figures
from recomputing.black_boxes import black_box_figures
from recomputing.coefficients import energy_by_terms, gain_of_coefficients
from recomputing.comparing import both_measures, gradient_labels, searches_in
from recomputing.efforts import efforts
from recomputing.features import prediction_figures
from recomputing.first_table import add_holm_of_table, judged_rows
from recomputing.further_axes import energy_of_families, further_figures
from recomputing.gaps import Results
from recomputing.gradient_alone import beaten, repeats
from recomputing.kinds_of_energy import against_differences, kind_figures
from recomputing.many_cores import parallel_figures
from recomputing.map_of_cells import by_indicator, map_figures
from recomputing.one_axis import (
    few_figures,
    limit_figures,
    million,
    noise_figures,
    objective_figures,
)
from recomputing.published import PAGES, differences, wrong_lines
from recomputing.runs import read_runs
from recomputing.tuning import both_tuned, tuned


def compute(folder: Path) -> dict[str, Any]:
    """All figures."""
    results = Results(read_runs(folder))
    centre = results.problems()
    in_crossing = searches_in(results, ("crossing",), 10_000, results.problems(4), 5)
    crossed = [label for label, _ in in_crossing]
    central = searches_in(results, ("centre",), 10_000, centre, 10)
    methods = [*central, *gradient_labels(results, centre)]
    paper = [
        pair
        for budget in (40_000, 100_000)
        for pair in searches_in(results, ("paper",), budget, centre, 5)
    ]
    large = searches_in(results, ("large",), 100_000, centre, 3)
    judged = judged_rows(results)
    arms = arm_figures(folder)
    basins = basins_figures(folder)
    add_holm_of_table(judged, arms, basins)
    return {
        **efforts(results, folder),
        **map_figures(results, crossed),
        **objective_figures(results),
        "energy_by_terms": energy_by_terms(results, crossed),
        "repeats": repeats(results),
        "beaten": beaten(results),
        "centre": both_measures(results, centre, methods),
        "paper": both_measures(results, centre, paper),
        "large": both_measures(results, centre, large),
        "million": million(results),
        "tuned": tuned(results, folder),
        "both_tuned": both_tuned(results, folder),
        "kinds": kind_figures(results),
        "noise": noise_figures(results),
        "limits": limit_figures(results),
        "few": few_figures(results),
        "further": further_figures(results),
        "families": energy_of_families(results),
        "parallel": parallel_figures(results, folder),
        "judged": judged,
        "indicators": by_indicator(results, crossed),
        "differences": against_differences(results, crossed),
        "gain": gain_of_coefficients(results, crossed),
        "attained": attained_figures(results, centre, methods),
        "profiles": runtime_profiles(results),
        "black_box": black_box_figures(folder),
        "arms": arms,
        "basins": basins,
        "prediction": prediction_figures(results, folder, crossed),
    }


def main(arguments: Sequence[str] | None = None) -> int:
    """Compare, or write."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("folder", nargs="?", type=Path, default=Path(__file__).parent)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args(arguments)
    folder = options.folder
    figures = json.loads(json.dumps(compute(folder)))
    path = folder / "figures.json"
    if options.write:
        path.write_text(json.dumps(figures, indent=1) + "\n")
        return 0
    published = json.loads(path.read_text())
    lines = differences(published, figures)
    print("\n".join(lines[:20]) if lines else "all figures are those of figures.json")
    try:
        wrong = wrong_lines(folder, published)
    except ImportError as error:
        print(f"{' and '.join(PAGES)} are not compared: {error}; run this in a checkout")
        return int(bool(lines))
    print("\n".join(wrong) if wrong else f"{' and '.join(PAGES)} have these figures")
    return int(bool(lines or wrong))


if __name__ == "__main__":
    sys.exit(main())
