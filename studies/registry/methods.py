"""The methods that find a front: the one registry that commands, tables and pictures read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import partial

from quietarm.metaheuristics import PRESETS
from quietarm.ocp import Front, epsilon_front, weighted_front
from quietarm.ocp.front.points import LEVELS

_POLISHED = ", polished"
"""What `quietarm.ocp.polish_front` adds to the name of a method."""


class Kind(Enum):
    """How a method works."""

    GRADIENT = "gradient"
    METAHEURISTIC = "metaheuristic"
    OTHER = "other"


def _no_sweep(*given: object, **settings: object) -> Front:
    raise ValueError("this method is not of the gradient; give it to metaheuristics.search")


@dataclass(frozen=True)
class Method:
    """A method that finds a front."""

    name: str
    label: str
    kind: Kind
    polished: bool = False
    sweep: Callable[..., Front] = field(default=_no_sweep, compare=False)

    def then_polished(self) -> Method:
        """The same method with its front polished."""
        between = ", " if self.polished else " "
        label = f"{self.label}{between}polished"
        return replace(self, name=f"{self.name}{_POLISHED}", label=label, polished=True)


EPSILON = Method(
    "epsilon", "epsilon constraint", Kind.GRADIENT, sweep=partial(epsilon_front, at=LEVELS)
)
WEIGHTED = Method("weighted", "weighted sum", Kind.GRADIENT, sweep=weighted_front)
METHODS = {
    method.name: method
    for method in (
        EPSILON,
        WEIGHTED,
        *(Method(name, preset.label, Kind.METAHEURISTIC) for name, preset in PRESETS.items()),
    )
}
"""Every method that a user can ask for, by name."""
NSGA2 = METHODS["nsga2"]


def method_of(name: str) -> Method:
    """The method that a front names."""
    if name in METHODS:
        return METHODS[name]
    if name.endswith(_POLISHED):
        return method_of(name.removesuffix(_POLISHED)).then_polished()
    return Method(name, name, Kind.OTHER)


def methods_of(kind: Kind) -> tuple[Method, ...]:
    """The methods of the registry of one kind."""
    return tuple(method for method in METHODS.values() if method.kind is kind)
