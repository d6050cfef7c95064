"""The gradient on moves between posts: epsilon-constraint by SLSQP with exact derivatives."""

from __future__ import annotations

from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from quietarm.metaheuristics.algorithms.differences import falling_shares

from .posts import PostsMove

Array = NDArray[np.float64]
POINTS = 40
"""Residual limits of a front."""
STARTS = 50
"""Local searches that count basins."""
WITHIN, SAME = 1e-2, 0.01
"""Residual [m] within which they minimise the energy; optima of one basin differ by less."""
SPARE = 1e-6
"""Room [m^2] that solutions keep, so that their digits do not break a limit."""


def chain(move: PostsMove, seed: int) -> Array:
    """Points of a front from one start: the cheapest motion, then limits that fall from there.

    Each limit starts at the motion of the next larger one, as finite-difference SLSQP does. Where
    the first start finds no way between the posts, another is drawn.
    """
    random = np.random.default_rng(seed)
    motions = dict[float, Array]()
    while not motions:
        start = random.uniform(move.lower, move.upper)
        cheapest, _ = least_energy(move, start, np.inf)
        if is_free(move, cheapest):
            motions[1.0] = cheapest
    reach = float(move(motions[1.0])[0][0, 0])
    for share in islice(falling_shares(), POINTS - 1):
        above = min(solved for solved in motions if solved > share)
        found, _ = least_energy(move, motions[above], share * reach)
        if is_free(move, found):
            motions[share] = found
    return move(np.array(list(motions.values())))[0]


def is_free(move: PostsMove, candidate: Array) -> bool:
    """Return whether a candidate hits no post."""
    return bool((move(candidate)[1] <= 0).all())


def least_energy(move: PostsMove, start: Array, limit: float) -> tuple[Array, bool]:
    """The end of SLSQP from a start, within a limit of the residual; and whether it converged."""
    known = dict[str, Any]()

    def at(x: Array) -> tuple[Array, Array]:
        if "x" not in known or not np.array_equal(known["x"], x):
            values, slopes = (part.full() for part in move.with_derivatives(x))
            known.update(x=x.copy(), both=(values[:, 0], slopes))
        return known["both"]

    scale = 1 / max(at(start)[0][1], 1e-9)
    rows = slice(2, None)
    constraints: list[dict[str, Any]] = [
        {"type": "ineq", "fun": lambda x: at(x)[0][rows] - SPARE, "jac": lambda x: at(x)[1][rows]}
    ]
    if np.isfinite(limit):
        constraints.append({
            "type": "ineq",
            "fun": lambda x: 1 - at(x)[0][0] / limit**2,
            "jac": lambda x: -at(x)[1][0] / limit**2,
        })  # fmt: skip
    result = minimize(
        lambda x: scale * at(x)[0][1], start, jac=lambda x: scale * at(x)[1][1],
        bounds=list(zip(move.lower, move.upper, strict=True)), constraints=constraints,
        method="SLSQP", options={"ftol": 1e-8, "maxiter": 200},
    )  # fmt: skip
    return np.clip(result.x, move.lower, move.upper), bool(result.success)


def basins(move: PostsMove) -> dict[str, Any]:
    """Local optima of the least energy within 10 mm, by SLSQP from random starts.

    optima : optima whose energies, or ways between the posts, differ
    ways : ways between the posts among these
    best : share of the solved ones that end within a per cent of the least energy
    """
    random = np.random.default_rng(64)
    found = list[tuple[float, tuple[int, ...]]]()
    for start in random.uniform(move.lower, move.upper, (STARTS, move.size)):
        end, converged = least_energy(move, start, WITHIN)
        (values,), violations = move(end)
        kept = values[0] <= WITHIN * (1 + 1e-3)
        if converged and kept and (violations <= 0).all():
            found.append((float(values[1]), move.way(end)))
    optima = list[tuple[float, tuple[int, ...]]]()
    for energy, way in sorted(found):
        if not any(way == other and energy <= (1 + SAME) * least for least, other in optima):
            optima.append((energy, way))
    least = min((energy for energy, _ in found), default=np.nan)
    return {
        "problem": move.name,
        "posts": len(move.posts),
        "coefficients": move.size,
        "starts": STARTS,
        "solved": len(found),
        "optima": len(optima),
        "ways": len({way for _, way in optima}),
        "best": sum(energy <= (1 + SAME) * least for energy, _ in found) / max(len(found), 1),
    }
