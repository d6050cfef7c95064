"""What the methods that find fronts are called."""

from __future__ import annotations

from quietarm.metaheuristics import PRESETS

GRADIENT_LABELS = {
    "epsilon": "epsilon constraint", "weighted": "weighted sum", "multistart": "multistart",
}  # fmt: skip
"""Methods of the gradient, which may name their solver, as ``epsilon:ipopt``."""
_SOLVERS = {"sqp": "SQP", "ipopt": "IPOPT"}
_POLISHED = ", polished", "+polish"
"""What `polish_front` and a job add to the name of a method."""


def unpolished(name: str) -> str:
    """The method whose front was polished, without its settings; any other name as it is."""
    for ending in _POLISHED:
        name = name.removesuffix(ending)
    return name


def is_gradient(method: str) -> bool:
    """Whether a method is the gradient's alone, by the name in a front or a job's label."""
    return unpolished(method.partition("(")[0]).partition(":")[0] in GRADIENT_LABELS


def label_of(method: str, solver: str = "") -> str:
    """A method in tables and pictures; of the gradient with its solver, named or given."""
    name, bracket, settings = method.partition("(")
    alone = unpolished(name)
    way, _, named = alone.partition(":")
    known = GRADIENT_LABELS | {name: preset.label for name, preset in PRESETS.items()}
    words = known.get(way, alone)
    if way in GRADIENT_LABELS and (solver := _SOLVERS.get(named or solver, "")):
        words += f", {solver}"
    if alone != name:
        words += ", polished"
    return f"{words} {bracket}{settings}" if bracket else words


def described(method: str) -> str:
    """A method of fronts with what it is, for who does not know its name: search (NSGA-II)."""
    return with_kind(label_of(method), is_gradient(method))


def with_kind(label: str, by_gradient: bool) -> str:
    """A method's label with what the method is: gradient (epsilon constraint)."""
    kind = "gradient" if by_gradient else "search"
    name = label.replace(" (", "; ").replace(")", "")
    return f"{kind} ({name})"
