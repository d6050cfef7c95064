"""What a picture is given: a refusal names the value and the remedy."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from quietarm.ocp import Front, Polish, Robustness
from quietarm.ocp.base.checks import of_kind
from quietarm.ocp.robustness.uncertain import on_assumed
from quietarm.studies.comparison.measures import Comparison

_OTHER_TASK = "give what was found for one move of one plant"
_A_FRONT = "a Front, as of epsilon_front, search or Front.load"


def front_given(front: Front) -> Front:
    """A front; ValueError where it is something else."""
    return of_kind("front", front, Front, _A_FRONT)


def comparison_given(comparison: Comparison) -> Comparison:
    """Fronts measured against each other; ValueError where it is something else."""
    return of_kind("comparison", comparison, Comparison, "what compare_fronts returns")


def polished_given(before: Front, polish: Polish) -> tuple[Front, Polish]:
    """A front and what polishing it gained; ValueError where they are none, or of other tasks."""
    front_given(before)
    of_kind("polish", polish, Polish, "what ocp.polish_front returns")
    if on_assumed(before.task) != on_assumed(polish.front.task):
        raise ValueError(f"polish is of another task than the front: {_OTHER_TASK}")
    return before, polish


def fronts_given(fronts: Sequence[Front]) -> list[Front]:
    """Fronts; ValueError where there is none, or one is something else."""
    listed = list(of_kind("fronts", fronts, Iterable, "a list of fronts"))
    if not listed:
        raise ValueError("there is no front to draw; give a list of one front or more")
    return [of_kind(f"front {i}", front, Front, _A_FRONT) for i, front in enumerate(listed, 1)]


def seeds_given(fronts: Sequence[Front]) -> list[Front]:
    """Fronts of one task; ValueError where they are none, or of several."""
    listed = fronts_given(fronts)
    for i, front in enumerate(listed, 1):
        if front.task != listed[0].task:
            raise ValueError(f"front {i} is of another task than front 1: {_OTHER_TASK}")
    return listed


def robustness_given(plans: Mapping[str, Robustness]) -> Mapping[str, Robustness]:
    """Figures by label; ValueError where there are none, or some are something else."""
    if not of_kind("plans", plans, Mapping, "figures of robustness by label"):
        raise ValueError("there is no plan to draw; give the figures of one or more by label")
    for label, plan in plans.items():
        of_kind(f"plan {label!r}", plan, Robustness, "what ocp.evaluate_robustness returns")
    return plans
