"""Small problems for VEPSO whose answers are known, and what its tests ask of its states."""

import numpy as np
from pymoo.core.problem import Problem


class Targets(Problem):
    """Objective s is the squared distance to a target of its own; remembers what it was asked."""

    def __init__(self, n_obj=2, n_var=3, **options):
        super().__init__(n_var=n_var, n_obj=n_obj, xl=-1.0, xu=2.0, **options)
        self.targets = np.eye(n_obj, n_var)
        self.X, self.F = [], []

    def _evaluate(self, x, out, *args, **kwargs):
        out["F"] = ((x[:, None, :] - self.targets) ** 2).sum(axis=2)
        self.X.append(x)
        self.F.append(out["F"])


class Constrained(Targets):
    """Feasible in a small corner only, x1 >= 1.9."""

    def __init__(self, **options):
        super().__init__(n_ieq_constr=1, **options)

    def _evaluate(self, x, out, *args, **kwargs):
        super()._evaluate(x, out)
        out["G"] = 1.9 - x[:, :1]


def state_of(algorithm):
    """Return what a swarm knows after an iteration: velocities, and the best so far."""
    names = ("velocities", "best_X", "best_merit", "swarm_best")
    known = {name: getattr(algorithm, name).copy() for name in names}
    return {**known, "random_state": algorithm.random_state.bit_generator.state}


def step(algorithm):
    algorithm.next()
    return state_of(algorithm)
