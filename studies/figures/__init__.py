"""Pictures of answers: motions, fronts, sweeps, comparisons, robustness.

Every ``draw_...`` draws on the matplotlib axes that it is given, or on new ones, and returns them;
every ``..._figure`` puts several together as the commands do. No picture is known to pyplot, so
none opens a window: save one with ``ax.figure.savefig("name.png")``. May import `comparison`,
`paper`, `registry` and `display`.
"""

from quietarm.studies.comparison.measures import Comparison, compare_fronts
from quietarm.studies.figures.comparison import (
    comparison_figure,
    draw_gaps,
    draw_still,
    draw_whole,
)
from quietarm.studies.figures.fronts import (
    draw_fronts,
    draw_hypervolume,
    draw_seed_energies,
    front_figure,
)
from quietarm.studies.figures.identification import identification_figure
from quietarm.studies.figures.looks import BLUE, COLOURS, GREEN, GREY, RED, Look, look
from quietarm.studies.figures.motion import (
    PAPER_PANELS,
    QUANTITIES_DRAWN,
    Line,
    draw_quantity,
    floor_figure,
    motion_figure,
)
from quietarm.studies.figures.robustness import draw_robustness, robustness_figure
from quietarm.studies.figures.sweep import (
    draw_polish,
    draw_savings,
    draw_sweep,
    polish_figure,
    sweep_figure,
)

__all__ = [
    "BLUE",
    "COLOURS",
    "GREEN",
    "GREY",
    "PAPER_PANELS",
    "QUANTITIES_DRAWN",
    "RED",
    "Comparison",
    "Line",
    "Look",
    "compare_fronts",
    "comparison_figure",
    "draw_fronts",
    "draw_gaps",
    "draw_hypervolume",
    "draw_polish",
    "draw_quantity",
    "draw_robustness",
    "draw_savings",
    "draw_seed_energies",
    "draw_still",
    "draw_sweep",
    "draw_whole",
    "floor_figure",
    "front_figure",
    "identification_figure",
    "look",
    "motion_figure",
    "polish_figure",
    "robustness_figure",
    "sweep_figure",
]
