"""Names of the methods that find fronts."""

from __future__ import annotations

import re

from quietarm.metaheuristics import PRESETS
from quietarm.metaheuristics.named_method import NamedMethod

GRADIENT_LABELS = {
    "epsilon": "epsilon constraint", "weighted": "weighted sum", "multistart": "multistart",
}  # fmt: skip
"""Methods by the gradient, by their names."""
_IN_BRACKETS = re.compile(r" \(([^()]*)\)")
_SOLVERS = {"sqp": "SQP", "ipopt": "IPOPT"}


def is_gradient(method: str) -> bool:
    """Return whether a method is the gradient's alone, by the name in a front or a job's label."""
    return NamedMethod.read(method).by_gradient


def label_of(method: str, solver: str = "") -> str:
    """A method in tables and pictures; of the gradient with its solver, named or given."""
    named = NamedMethod.read(method)
    known = GRADIENT_LABELS | {name: preset.label for name, preset in PRESETS.items()}
    words = known.get(named.method, named.method)
    if named.by_gradient and (solver := _SOLVERS.get(named.solver or solver, "")):
        words += f", {solver}"
    if named.polish:
        words += ", polished"
    return f"{words} {named.settings}" if named.settings else words


def described(method: str) -> str:
    """A method of fronts with what it is, for who does not know its name: search (NSGA-II)."""
    return with_kind(label_of(method), is_gradient(method))


def with_kind(label: str, by_gradient: bool) -> str:
    """A method's label with what the method is: gradient (epsilon constraint)."""
    kind = "gradient" if by_gradient else "search"
    name = _IN_BRACKETS.sub(r"; \1", label)  # settings; the brackets of (1+1)-ES are its name's
    return f"{kind} ({name})"
