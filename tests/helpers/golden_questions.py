"""Some forty questions with known answers, asked by public functions only.

    python tests/helpers/golden_questions.py [name ...]

writes the answers of this version to `tests/ocp/golden_answers.json`, all or those named;
`tests/ocp/test_golden_answers.py` holds every later version against them. They are those of
commit 9b4f93f8.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import quietarm as qa
from quietarm.ocp import CycloidGaussians, CycloidNetwork, ModalState, PositivePower

ANSWERS = Path(__file__).parents[1] / "ocp" / "golden_answers.json"
PEAKS = "torque", "speed", "acceleration", "jerk", "deflection"
KEPT, SOLVED, REPLACED, ROBUST = 1e-9, 1e-7, 1e-6, 1e-4
"""Relative tolerances: of what is only computed; of energies by the same solver, which ends up to
6e-8 beside another end of its own in the same flat minimum; of energies by another algorithm; and
of robust energies, as limits between the scenarios are kept to a share of about 1e-3."""
FLAT = 1e-4
"""Relative tolerance of a minimum's peaks: energy changes by the square of what they change by."""
REST = 1e-8
"""Residuals are compared within this many metres, beside 1e-6 of themselves."""

Answer = dict[str, float | list[float]]


@dataclass(frozen=True)
class Question:
    """Question, with the tolerances to which its answer and its peaks are held."""

    ask: Callable[[], Answer]
    relative: float = SOLVED
    peaks: float = FLAT

    def tolerance(self, name: str) -> tuple[float, float]:
        """Relative and absolute tolerance of a number by its name."""
        if name in ("residual", "worst"):
            return max(self.relative, REPLACED), REST
        return self.peaks if name.startswith("peak_") else self.relative, 0.0


def paper_move(plant: Any, *move: float, **options: Any) -> qa.PointToPoint:
    """A move with the residual window of the paper, equation (11)."""
    return qa.PointToPoint(plant, *move, residual_window=1.0, **options)


LINK, ARM, DUAL = qa.SingleLinkManipulator(), qa.ArmOnFlexibleLink(), qa.DualLinkManipulator()
BEAM = qa.FlexibleBeam()
PAPER = {
    "link pi/6 0.8": (paper_move(LINK, math.pi / 6, 0.8), 0.2),
    "link pi/2 1.0": (paper_move(LINK, math.pi / 2, 1.0), 0.2),
    "link pi/2 1.1": (paper_move(LINK, math.pi / 2, 1.1), 0.2),
    "arm pi/2 0.8": (paper_move(ARM, math.pi / 2, 0.8), 0.5),
    "arm 3pi/4 1.0": (paper_move(ARM, math.pi / 4, 1.0, -math.pi / 2), 0.5),
    "arm pi 1.2": (paper_move(ARM, math.pi / 2, 1.2, -math.pi / 2), 0.5),
}
"""The paper's driving conditions with its boxes: sections 3.1 and 3.2."""
PRINTED = {
    "link pi/6 0.8": (-1.889e-3, -1.427e-1, -4.247e-2, -1.187e-1, 4.800e-2, -1.890e-1),
    "arm pi/2 0.8": (-9.346e-2, -3.488e-1, 1.989e-1, -1.515e-1, -2.993e-2, -2.377e-1),
}
"""Tables 1 and 4, N = 6, with the exponent of a_5 mended."""
SIXTH, HALF = PAPER["link pi/6 0.8"][0], PAPER["arm pi/2 0.8"][0]


def link(**options: Any) -> qa.PointToPoint:
    """The link's first condition with limits, an energy or an initial state."""
    return paper_move(LINK, math.pi / 6, 0.8, **options)


def arm(**options: Any) -> qa.PointToPoint:
    """Return a move of the arm."""
    return paper_move(ARM, math.pi / 2, 0.8, **options)


def uncertain(plant: Any, target: float, duration: float, **ranges: float) -> qa.PointToPoint:
    """A move of a plant whose parameters are known within ranges."""
    return paper_move(plant, target, duration, uncertainty=qa.Uncertainty(ranges))


def figures(plan: Any) -> Answer:
    """Energy, residual and peaks of a plan."""
    peaks = {f"peak_{name}": plan.motion.peak(name) for name in PEAKS}
    return {"energy": plan.energy, "residual": plan.residual, **peaks}


def plan(task: qa.PointToPoint, terms: int = 6, **options: Any) -> Answer:
    """A plan's figures."""
    profile = options.pop("profile", None) or qa.CycloidPolynomial(terms)
    return figures(qa.plan_move(task, profile, **options))


def robust(task: qa.PointToPoint, **options: Any) -> Answer:
    """A robust plan's energy, and its worst case."""
    found = qa.plan_move(task, **options)
    assert found.worst is not None
    return {"energy": found.energy, "worst": found.worst.residual}


def front(task: qa.PointToPoint, bound: float, widest: float) -> Answer:
    """Energies of a front of twelve points: its ends, and at shares of a residual [m] besides."""
    at = [share * widest for share in (0.05, 0.15, 0.3, 0.6, 0.9)]
    found = qa.epsilon_front(task, bound=bound, points=12, at=at)
    residuals, energies = found.residuals, found.energies
    nearest = [int(np.abs(residuals - one).argmin()) for one in at]
    assert np.allclose(residuals[nearest], at, rtol=1e-4, atol=0), residuals
    return {
        "at": energies[nearest].tolist(),
        "first": float(energies[residuals.argmin()]),
        "last": float(energies.min()),
    }


def weighted(task: qa.PointToPoint, bound: float) -> Answer:
    """Least weighted sums of a front's residual and energy, scaled to 10 mm and 0.02 J."""
    weights = [(0.1, 0.9), (0.3, 0.7), (0.5, 0.5), (0.7, 0.3), (0.9, 0.1)]
    found = qa.weighted_front(task, bound=bound, weights=weights)
    scaled = np.column_stack([found.residuals / 0.01, found.energies / 0.02])
    return {"sums": (scaled @ np.transpose(weights)).min(axis=0).tolist()}


def floor(task: qa.PointToPoint) -> Answer:
    """The energy of the best free motion, and its residual."""
    found = qa.energy_floor(task)
    return {"energy": found.energy, "residual": found.residual}


def evaluated(task: qa.PointToPoint, coefficients: ArrayLike, **options: Any) -> Answer:
    """Figures of one motion."""
    return figures(qa.evaluate_coefficients(task, coefficients, **options))


def shaped(task: qa.PointToPoint, shaper: str) -> Answer:
    """Figures of a cycloid through an input shaper."""
    return figures(qa.plan_move(task, qa.shaped_cycloid(task, shaper)))


def many(plant: Any) -> Answer:
    """Energies of twenty moves at once."""
    random = np.random.default_rng(1)
    given = zip(random.uniform(0.4, 1.5, 20), random.uniform(0.8, 1.2, 20), strict=True)
    found = qa.plan_moves([paper_move(plant, *move) for move in given])
    return {"energy": found.energy.tolist(), "residual": found.residual.tolist()}


def fastest() -> Answer:
    """The shortest duration within a limit of the torque."""
    found = qa.fastest_move(link(torque_limit=0.2), qa.CycloidPolynomial(6))
    return {"duration": found.plan.task.duration}


def swing(omega: float, zeta: float, rate: float, seconds: float) -> tuple[NDArray, NDArray]:
    """A free vibration of 20 mm with 5 % of noise, seed 0: times and tip."""
    time = np.arange(0.0, seconds, 1 / rate)
    noise = np.random.default_rng(0).standard_normal(len(time))
    damped = omega * math.sqrt(1 - zeta**2)
    return time, 0.02 * (np.exp(-zeta * omega * time) * np.cos(damped * time) + 0.05 * noise)


def identified(plant: Any, omega: float, zeta: float) -> Answer:
    """Parameters from a made-up ring-down."""
    time, tip = swing(omega, zeta, 200.0, 6.0)
    found = qa.identify([qa.Recording(time, tip=tip)], plant)
    return {one.parameter: one.value for one in found.estimates}


def _plans() -> dict[str, Question]:
    mix = 0.5 * qa.AbsolutePower() + qa.CopperLoss(0.12)
    state = ModalState((0.004,), (0.02,))
    final = ModalState((0.001,), (0.0,))
    asked: dict[str, Callable[[], Answer]] = {}
    for name, (task, bound) in PAPER.items():
        asked[f"plan {name} in its box"] = partial(plan, task, bound=bound)
        asked[f"plan {name}"] = partial(plan, task)
    asked |= {
        "plan dual link": partial(plan, paper_move(DUAL, math.pi / 2, 0.9), bound=0.5),
        "plan beam": partial(plan, paper_move(BEAM, math.pi / 4, 0.9)),
        "plan torque": partial(plan, arm(torque_limit=0.3)),
        "plan speed": partial(plan, link(speed_limit=1.2)),
        "plan acceleration": partial(plan, link(acceleration_limit=20.0)),
        "plan jerk": partial(plan, link(jerk_limit=300.0)),
        "plan deflection": partial(plan, link(deflection_limit=0.042)),
        "plan 1 mm": partial(plan, PAPER["link pi/2 1.0"][0], residual_limit=1e-3, bound=0.2),
        "plan 8 terms": partial(plan, HALF, 8, bound=0.5),
        "plan 12 terms": partial(plan, SIXTH, 12, bound=0.2),
        "plan 16 terms": partial(plan, HALF, 16, bound=0.5),
        "plan gaussians": partial(plan, SIXTH, profile=CycloidGaussians(3), bound=2.0),
        "plan network": partial(plan, HALF, profile=CycloidNetwork(3), bound=2.0),
        "plan spline": partial(plan, SIXTH, profile=qa.CycloidSpline(6)),
        "plan positive power": partial(plan, link(energy=PositivePower())),
        "plan copper": partial(plan, arm(energy=qa.CopperLoss(0.12))),
        "plan mix": partial(plan, link(energy=mix)),
        "plan initial state": partial(plan, link(initial=state)),
        "plan final state": partial(plan, link(final=final)),
        "plan ipopt link": partial(plan, SIXTH, bound=0.2, solver=qa.Ipopt()),
        "plan ipopt arm": partial(plan, HALF, bound=0.5, residual_limit=2e-3, solver=qa.Ipopt()),
    }
    by_ipopt = {name for name in asked if "ipopt" in name}
    limited = {f"plan {name}" for name in PEAKS}  # what is taken off between the nodes may change
    changing = by_ipopt | limited
    return {
        name: Question(ask, REPLACED if name in changing else SOLVED) for name, ask in asked.items()
    }


def _searches() -> dict[str, Question]:
    asked: dict[str, Question] = {
        f"front {name}": Question(partial(front, *PAPER[name], widest), REPLACED)
        for name, widest in zip(PAPER, (0.035, 0.07, 0.06, 0.01, 0.006, 0.0065), strict=True)
    }
    asked |= {
        "weighted front": Question(partial(weighted, HALF, 0.5), REPLACED),
        "floor limited": Question(partial(floor, arm(acceleration_limit=100.0)), REPLACED),
        "robust link": Question(
            partial(robust, uncertain(LINK, math.pi / 6, 0.8, frequency=0.1), residual_limit=4e-3),
            ROBUST,
        ),
        "robust arm": Question(
            partial(robust, uncertain(ARM, math.pi, 1.2, frequency=0.05), residual_limit=5e-3),
            ROBUST,
        ),
        "robust two errors": Question(
            partial(
                robust,
                uncertain(LINK, math.pi / 2, 1.0, frequency=0.05, damping=0.3),
                residual_limit=8e-3,
            ),
            ROBUST,
        ),
        "many moves of the link": Question(partial(many, LINK)),
        "many moves of the arm": Question(partial(many, ARM)),
        "fastest": Question(fastest, 1e-3),
    }
    return asked


def _evaluations() -> dict[str, Question]:
    asked: dict[str, Callable[[], Answer]] = {
        "identified beam": partial(identified, BEAM, 2 * math.pi * 3.2, 0.01),
        "identified link": partial(identified, LINK, 12.0, 0.02),
    }
    for name, coefficients in PRINTED.items():
        asked[f"printed {name}"] = partial(evaluated, PAPER[name][0], coefficients)
    asked |= {
        "cycloid of the dual link": partial(evaluated, paper_move(DUAL, math.pi / 2, 0.9), []),
        "zvd link": partial(shaped, PAPER["link pi/2 1.0"][0], "zvd"),
        "zv arm": partial(shaped, PAPER["arm pi 1.2"][0], "zv"),
        "printed on uncertain link": partial(
            evaluated, uncertain(LINK, math.pi / 6, 0.8, frequency=0.1), PRINTED["link pi/6 0.8"]
        ),
    }
    return {name: Question(ask, KEPT, REPLACED) for name, ask in asked.items()}


QUESTIONS: Mapping[str, Question] = {**_evaluations(), **_plans(), **_searches()}


def main(names: list[str]) -> None:
    """Answer the questions of these names, or all, and keep the answers."""
    answers = json.loads(ANSWERS.read_text()) if ANSWERS.exists() and names else {}
    for name in names or QUESTIONS:
        answers[name] = QUESTIONS[name].ask()
        print(name, flush=True)
    ANSWERS.write_text(json.dumps(answers, indent=1) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
