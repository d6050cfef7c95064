"""Searches that quietarm does not have: other libraries' solvers, and a program of twenty lines.

Each asks a problem's recorded function for candidates until its budget is spent. The libraries are
needed when one is run, in an environment of your own:

    pip install cobyqa Py-BOBYQA PyNomadBBO comocma

None is a dependency of quietarm.
"""

from __future__ import annotations

import logging
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.metaheuristics.algorithms.differences import falling_shares
from quietarm.metaheuristics.problems.recorded import BudgetSpentError

Array = NDArray[np.float64]
FIRST = 0.25
"""First radius of a local solver, as a share of the box, and that of a continued one."""
CONTINUED, LAST = 0.05, 1e-4
PENALTY = 10.0
"""What a violation of a tenth costs, where a library knows no constraints; see `penalised`."""


class OneByOne:
    """A recorded function of one candidate, in a box from 0 to 1; the last value is kept."""

    def __init__(self, function: Any) -> None:
        self.function = function
        self.lower, self.size = function.lower, function.upper - function.lower
        self.count = len(self.lower)
        self._last: tuple[Array, tuple[Array, Array]] | None = None

    def __call__(self, x: Array) -> tuple[Array, Array]:
        """Objectives and violations of one candidate."""
        x = np.clip(np.asarray(x, dtype=float), 0, 1)
        if self._last is None or not np.array_equal(self._last[0], x):
            objectives, violations = self.function((self.lower + x * self.size)[None])
            self._last = x.copy(), (objectives[0], violations[0])
        return self._last[1]


def twenty_lines(function: Any, seed: int, budget: int) -> None:
    """A (1+1)-ES with an archive, written anew: success rule, random parent, feasibility first."""
    random = np.random.default_rng(seed)
    of = OneByOne(function)
    X, F, V = np.empty((0, of.count)), np.empty((0, 2)), np.empty(0)
    x, step = random.random(of.count), 0.3
    while True:
        f, violations = of(x)
        v = np.maximum(violations, 0).sum()
        is_beaten = ((v > V) | ((v == V) & (f >= F).all(axis=1))).any()
        if not is_beaten:
            stays = (v > V) | ((v == V) & ~(f <= F).all(axis=1))
            X, F, V = np.vstack([X[stays], x]), np.vstack([F[stays], f]), np.append(V[stays], v)
        step = np.clip(step * (0.95 if is_beaten else 1.22), 2e-3, 0.5)
        parent = X[random.integers(len(X))]
        x = np.clip(parent + step * random.standard_normal(of.count), 0, 1)


def cobyqa(function: Any, seed: int, budget: int) -> None:
    """COBYQA (Ragonneau and Zhang 2024), with the residual limits and restarts of `slsqp`."""
    from cobyqa import minimize
    from scipy.optimize import Bounds, NonlinearConstraint

    random, of = np.random.default_rng(seed), OneByOne(function)

    def solve(start: Array, limit: float, reach: float, radius: float) -> Array:
        scale = 1 / max(abs(of(start)[0][1]), 1e-12)

        def room(x: Array) -> Array:
            objectives, violations = of(x)
            over = [(objectives[0] - limit) / reach] if np.isfinite(limit) else []
            return np.array([*violations, *over])

        constraints = [NonlinearConstraint(room, -np.inf, 0)] if len(room(start)) else []
        options = {
            "initial_tr_radius": radius, "final_tr_radius": LAST, "maxfev": 40 * of.count,
            "feasibility_tol": 1e-6,
        }  # fmt: skip
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = minimize(
                lambda x: scale * of(x)[0][1], start,
                bounds=Bounds(np.zeros(of.count), np.ones(of.count)), constraints=constraints,
                options=options,
            )  # fmt: skip
        return np.clip(found.x, 0, 1)

    while True:
        motions = {1.0: solve(random.random(of.count), np.inf, np.inf, FIRST)}
        reach = max(float(of(motions[1.0])[0][0]), 1e-12)
        for share in falling_shares():
            above = min(solved for solved in motions if solved > share)
            motions[share] = solve(motions[above], share * reach, reach, CONTINUED)


def penalised(objectives: Array, violations: Array, weight: float, scale: Array) -> float:
    """A weighted Chebyshev norm, and violations in units of a hundredth."""
    broken = float(np.maximum(violations, 0).sum())
    weights = np.array([weight, 1 - weight]) / scale
    return float((weights * objectives).max() + 0.05 * (weights * objectives).sum()) + (
        PENALTY * min(broken / 0.01, 1e3)
    )


def pybobyqa(function: Any, seed: int, budget: int) -> None:
    """Py-BOBYQA (Cartis and others 2019) on random weights, from random starts or the last end."""
    import pybobyqa as library

    logging.disable(logging.WARNING)
    random, of = np.random.default_rng(seed), OneByOne(function)
    scale = np.maximum(np.abs(of(np.full(of.count, 0.5))[0]), 1e-9)
    box = np.zeros(of.count), np.ones(of.count)
    end, radius = random.random(of.count), FIRST
    np.random.seed(seed)  # noqa: NPY002 (the library draws from it)
    while True:
        weight = float(random.random())
        found = library.solve(
            lambda x, weight=weight: penalised(*of(x), weight, scale), np.clip(end, 0, 1),
            bounds=box, rhobeg=radius, rhoend=LAST, maxfun=40 * of.count, do_logging=False,
        )  # fmt: skip
        restart = found.x is None or random.random() < 0.2
        end = random.random(of.count) if restart else found.x
        radius = FIRST if restart else CONTINUED


def nomad(function: Any, seed: int, budget: int) -> None:
    """DMulti-MADS (Bigeon, Le Digabel and Salomon 2021), NOMAD's direct multisearch."""
    import PyNomad

    of, random = OneByOne(function), np.random.default_rng(seed)
    spent = list[BaseException]()

    def evaluate(point: Any) -> int:
        if spent:
            return 0
        try:
            objectives, violations = of([point.get_coord(i) for i in range(of.count)])
        except BudgetSpentError as error:
            spent.append(error)
            return 0
        point.setBBO(
            " ".join(map(repr, [*map(float, objectives), *map(float, violations)])).encode()
        )
        return 1

    outputs = " ".join(["OBJ OBJ", *["PB"] * len(of(np.full(of.count, 0.5))[1])])
    parameters = [
        f"BB_OUTPUT_TYPE {outputs}", "DMULTIMADS_OPTIMIZATION true", "QUAD_MODEL_SEARCH no",
        "DMULTIMADS_SELECT_INCUMBENT_THRESHOLD 5", f"MAX_BB_EVAL {budget}", f"SEED {seed}",
        "DISPLAY_DEGREE 0", "DIRECTION_TYPE ORTHO 2N",
    ]  # fmt: skip
    while not spent:
        start = random.random(of.count).tolist()
        PyNomad.optimize(evaluate, start, [0.0] * of.count, [1.0] * of.count, parameters)
        if not spent and of.function.archive.evaluations >= budget - 1:
            break


def como_cma_es(function: Any, seed: int, budget: int) -> None:
    """COMO-CMA-ES (Touré and others 2019) with five kernels; violations are a penalty."""
    import comocma

    of, random = OneByOne(function), np.random.default_rng(seed)
    scale = np.maximum(np.abs(of(np.full(of.count, 0.5))[0]), 1e-9)
    warnings.simplefilter("ignore")
    kernels = comocma.get_cmas(
        [random.random(of.count) for _ in range(5)], 0.2,
        {"bounds": [0, 1], "verbose": -9, "seed": seed + 1, "tolx": 1e-6},
    )  # fmt: skip
    moes = comocma.Sofomore(kernels, reference_point=[2.0, 2.0], opts={"archive": True})
    while True:
        candidates = moes.ask()
        values = list[list[float]]()
        for x in candidates:
            objectives, violations = of(x)
            broken = float(np.maximum(violations, 0).sum())
            values.append([*(objectives / scale + PENALTY * min(broken / 0.01, 1e3))])
        moes.tell(candidates, values)


RIVALS: dict[str, Callable[[Any, int, int], None]] = {
    "(1+1)-ES of twenty lines": twenty_lines,
    "COBYQA": cobyqa,
    "Py-BOBYQA": pybobyqa,
    "DMulti-MADS": nomad,
    "COMO-CMA-ES": como_cma_es,
}
"""By the name that tables have."""
