"""Sentences above pictures: what is seen, in the figures of the answer that is drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from quietarm.metaheuristics.spread import SEARCH_RESIDUAL
from quietarm.ocp import Floor, Front, FrontPoint, JudgedMotion, Plan, Polish
from quietarm.ocp.joint_words import further_words, spans_in_words
from quietarm.ocp.limits import CAPTION
from quietarm.ocp.rest import is_at_rest
from quietarm.ocp.robustness import worst_of
from quietarm.ocp.task import PointToPoint
from quietarm.views.report.words import error_words, scenarios_words
from quietarm.views.tips import tip_words

if TYPE_CHECKING:
    from quietarm.studies.compare.compared_motions import ComparedMotion

_WORST = " in the worst case"
_MOST_SAID = 3
"""Of more motions a sentence says only between which figures they are."""


def caption_of_motions(motions: Mapping[str, Plan | Floor]) -> str:
    """Say what motions take and leave, by name: "The plan takes 0.02 J and arrives at rest"."""
    said = [
        _Said(name, motion.energy, _left_by(motion), _said(motion))
        for name, motion in motions.items()
    ]
    return _caption(said, [motion.candidate for motion in motions.values()])


def caption_of_judged(motions: Sequence[ComparedMotion]) -> str:
    """Say what compared motions take and leave; of an uncertain plant by their worst cases."""
    known = {judged.name: judged for judged in motions if judged.motion is not None}
    said = list[_Said]()
    for name, judged in known.items():
        assert judged.motion is not None
        left = judged.motion.residual
        words = left_words(left, judged.task)
        if judged.worst is not None:
            left = judged.worst.residual
            words = f"{left_words(left, judged.task)}{_WORST}"
        if judged.motion.candidate is not None:
            words = ", ".join([words, *further_words(judged.motion.candidate, CAPTION)])
        left = 0.0 if is_at_rest(left, judged.task) else left
        said.append(_Said(name, judged.motion.energy, left, words))
    candidates = [judged.motion.candidate for judged in known.values() if judged.motion is not None]
    judged_by_cvodes = [candidate for candidate in candidates if candidate is not None]
    return _caption(said, judged_by_cvodes)


class _Said(NamedTuple):
    """One motion as a sentence says it: energy [J], what it leaves [m], how it ends in words."""

    name: str
    energy: float
    left: float
    words: str


def _caption(said: Sequence[_Said], candidates: Sequence[JudgedMotion]) -> str:
    if not said:
        return "None of these motions is possible"
    if len(said) > _MOST_SAID:
        caption = _best_of(said) + _spans(candidates)
    else:
        caption = "; ".join(
            f"{_named(one.name)} takes {one.energy:.3g} J and {one.words}" for one in reversed(said)
        )
    return caption[:1].upper() + caption[1:]


def _best_of(said: Sequence[_Said]) -> str:
    """Say which of many motions is the stillest, and which takes the least energy."""
    still = min(said, key=lambda one: (one.left, one.energy))
    cheap = min(said, key=lambda one: one.energy)
    first = f"{_named(still.name)} {still.words} for {still.energy:.3g} J"
    if cheap is still:
        words = f"{first}, the stillest and cheapest of {len(said)} motions"
    else:
        words = (
            f"{first}, the stillest of {len(said)} motions; "
            f"{_named(cheap.name)} is the cheapest: {cheap.energy:.3g} J, and {cheap.words}"
        )
    if _WORST in words:
        return f"In the worst case {words.replace(_WORST, '')}"
    return words


def _left_by(motion: Plan | Floor) -> float:
    """Return what a motion leaves [m], a robust plan in the worst case; 0 if that is rest."""
    worst = motion.worst if isinstance(motion, Plan) else None
    left = motion.residual if worst is None else worst.residual
    return 0.0 if is_at_rest(left, motion.task) else left


def _spans(candidates: Sequence[JudgedMotion]) -> str:
    """The ranges of a user's own figures over several motions, after a semicolon."""
    return "".join(f"; {words}" for words in spans_in_words(candidates, CAPTION))


def _said(motion: Plan | Floor) -> str:
    """Say how a motion ends, with the figures of the user's own."""
    return ", ".join([_ending(motion), *further_words(motion.candidate, CAPTION)])


def _named(name: str) -> str:
    """A name within a sentence: the plain cycloid."""
    articled = ("plain cycloid", "cycloid", "plan", "robust plan", "floor")
    return f"the {name}" if name in articled or name.startswith("plan of") else name


def _ending(motion: Plan | Floor) -> str:
    """Say how a motion ends: at rest, or what it leaves, of a robust plan in the worst case."""
    task = motion.task
    if isinstance(motion, Plan) and motion.worst is not None:
        worst = left_words(motion.worst.residual, task)
        return f"{worst} with {error_words(task)}"
    if is_at_rest(motion.residual, task) and task.final:
        return "arrives in the state that is wanted"
    return left_words(motion.residual, task)


def left_words(residual: float, task: PointToPoint) -> str:
    """Return what a residual means: "arrives at rest", or "leaves 5 mm"."""
    if is_at_rest(residual, task):
        return "arrives at rest"
    return f"leaves {tip_words(residual, task.plant.tip_unit)}"


def verified_words(motions: Sequence[Plan | Floor]) -> str:
    """Say how a picture's figures are verified: by how much another integrator differs."""
    checks = [motion.verification for motion in motions if isinstance(motion, Plan)]
    if not checks:
        return "by a second integrator"
    share = max(check.energy_share for check in checks)
    if all(check.agrees for check in checks):
        return "checked by a second integrator"
    return f"not verified: a second integrator differs by {share:.0e} of the energy"


def caption_of_front(front: Front) -> str:
    """Say what a front trades: from its stillest to its cheapest motion."""
    tip_unit = front.task.plant.tip_unit
    if not front.points:
        return "No point of this front was found"
    stillest = front.points[0]
    cheapest = min(front.points, key=lambda point: point.energy)
    worst = worst_of(front.judged(stillest))
    still = scenarios_words(stillest.residual, worst, front.task)
    still = "at rest" if still == "rest" else f"with {still}"
    words = f"{stillest.energy:.3g} J {still}{_further(front, stillest)}"
    if len(front.points) == 1:
        return f"One motion: {words}"
    saved = 100 * (1 - cheapest.energy / stillest.energy)
    cheap = f"{cheapest.energy:.3g} J with {tip_words(cheapest.residual, tip_unit)}"
    return (
        f"From {words} to {cheap}{_further(front, cheapest)}: this vibration saves {saved:.3g} % "
        "of the energy"
    )


def _further(front: Front, point: FrontPoint) -> str:
    """A user's own figures of a point, in brackets."""
    words = ", ".join(further_words(front.judged(point), CAPTION))
    return f" ({words})" if words else ""


def caption_of_fronts(fronts: Sequence[Front], level: float = SEARCH_RESIDUAL) -> str:
    """Say what seeds of one method take within a residual [m]."""
    if len(fronts) == 1:
        return caption_of_front(fronts[0])
    within = tip_words(level, fronts[0].task.plant.tip_unit)
    energies = [front.least_energy(level) for front in fronts]
    reached = [energy for energy in energies if energy < float("inf")]
    if not reached:
        return f"None of {len(fronts)} seeds comes within {within}"
    least, most = (f"{energy:.4g}" for energy in (min(reached), max(reached)))
    verb = "takes" if len(reached) == 1 else "take"
    span = least if least == most else f"{least} to {most}"
    return (
        f"Within {within}, {len(reached)} of {len(fronts)} seeds {verb} {span} J"
        f"{spans_of_fronts(fronts, level)}"
    )


def spans_of_fronts(fronts: Sequence[Front], level: float) -> str:
    """The ranges of a user's own figures over the cheapest motions within a residual [m]."""
    points = [(front, front.cheapest_within(level)) for front in fronts]
    return _spans([front.judged(point) for front, point in points if point is not None])


def caption_of_polish(polish: Polish) -> str:
    """Say what polishing saves."""
    shares = [100 * gain.share for gain in polish.gains]
    if not shares:
        return "No point was polished"
    return f"Polishing saves up to {max(shares):.2g} % of the energy of a point"


def caption_of_cells(
    energies: NDArray[np.float64],
    residuals: NDArray[np.float64],
    task: PointToPoint,
    more: Sequence[str] = (),
) -> str:
    """Say how many cells of a grid have a plan, what these take and leave, and `more` beside it."""
    planned = np.isfinite(energies)
    words = f"{planned.sum()} of {planned.size} moves have a plan"
    if not planned.any():
        return words
    low = energies[planned].min()
    high = energies[planned].max()
    left = residuals[planned].max()
    arrival = "all arrive at rest"
    if not is_at_rest(left, task):
        arrival = f"they leave up to {tip_words(float(left), task.plant.tip_unit)}"
    return "; ".join([f"{words}, of {low:.3g} to {high:.3g} J", arrival, *more])
