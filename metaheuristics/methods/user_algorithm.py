"""Check that a user's own algorithm can search a trade-off."""

from __future__ import annotations

import copy

from pymoo.core.algorithm import Algorithm


def copy_of_algorithm(algorithm: Algorithm) -> Algorithm:
    """A copy to run, so that the one given stays as it is."""
    name = type(algorithm).__name__
    # pymoo says nowhere else how many objectives an algorithm is for, and some would run on
    if any(kind.__module__.startswith("pymoo.algorithms.soo") for kind in type(algorithm).__mro__):
        raise ValueError(
            f"{name} minimises one objective, and a move has two or more; give a multi-objective "
            "algorithm, such as those of pymoo.algorithms.moo"
        )
    if algorithm.problem is not None or algorithm.is_initialized:
        raise ValueError(f"this {name} was set up or run before; give a new one")
    return copy.deepcopy(algorithm)
