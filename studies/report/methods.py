"""What the methods that find fronts are called."""

from __future__ import annotations

from quietarm.metaheuristics import PRESETS

GRADIENT = {
    "epsilon": "epsilon constraint", "weighted": "weighted sum", "multistart": "multistart",
}  # fmt: skip
"""Methods of the gradient, which may name their solver, as ``epsilon:ipopt``."""
_SOLVERS = {"sqp": "SQP", "ipopt": "IPOPT"}
_POLISHED = ", polished", "+polish"
"""What `polish_front` and a job add to the name of a method."""


def is_gradient(method: str) -> bool:
    """Whether a method is the gradient's alone, by the name in a front or a job's label."""
    return method.partition("(")[0].partition(":")[0] in GRADIENT


def label_of(method: str, solver: str = "") -> str:
    """A method in tables and pictures; of the gradient with its solver, named or given."""
    name, bracket, settings = method.partition("(")
    for ending in _POLISHED:
        if name.endswith(ending):
            words = f"{label_of(name.removesuffix(ending), solver)}, polished"
            break
    else:
        way, _, named = name.partition(":")
        solver = _SOLVERS.get(named or solver, "") if way in GRADIENT else ""
        known = GRADIENT | {one: preset.label for one, preset in PRESETS.items()}
        words = f"{known.get(way, name)}{', ' if solver else ''}{solver}"
    return f"{words} {bracket}{settings}" if bracket else words
