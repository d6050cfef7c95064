"""The paper recomputed with short searches and few starts."""

from quietarm.studies.reproduce.recompute import Effort

SHORT = Effort(
    full=True,
    searches={
        "vepso": {"population": 20, "generations": 40},
        "nsga2-paper": {"population": 20, "generations": 3},
    },
    starts=1,
    other_starts=1,
    points=3,
    free_motion={"starts": 1, "tolerance": 0.05},
)
