"""The settings of methods, each defined once: the argument of an algorithm, its name and values."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from quietarm.ocp.checks import finite, has_no, nearest, not_negative, positive, whole
from quietarm.ocp.solvers.solver import NAME, Option

Value = float | int | bool | str | None
Check = Callable[[str, Any], Value]


def _number(wanted: str, fits: Callable[[float], bool]) -> Check:
    def check(name: str, value: object) -> float:
        number = finite(name, value)
        if not fits(number):
            raise ValueError(f"{name} is {number:g}; give {wanted}")
        return number

    return check


def _yes_or_no(name: str, value: object) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"{name} is {value!r}; give true or false")
    return value


def _one_of(*choices: str) -> Check:
    def check(name: str, value: object) -> str:
        if value not in choices:
            hint = nearest(str(value), choices)
            raise ValueError(f"{name} is {value!r}; give one of {', '.join(choices)}{hint}")
        return str(value)

    return check


def _count(least: int) -> Check:
    # most points in an archive
    most = 100_000
    return lambda name, value: whole(name, value, least, most)


_share = _number("a number from 0 to 1", lambda number: 0 <= number <= 1)
_positive_share = _number("a positive number up to 1", lambda number: 0 < number <= 1)
_scale = _number("a positive number up to 2", lambda number: 0 < number <= 2)
# pymoo allows 1 to 100, both left out
_index = _number("a number between 1 and 100", lambda number: 1 < number < 100)
_variant = _one_of(
    *(
        f"DE/{base}/{number}/{cross}"
        for base in ("rand", "best", "current-to-best", "current-to-rand", "ranked")
        for number in (1, 2)
        for cross in ("bin", "exp")
    )
)

_ARGUMENTS: Mapping[str, tuple[str, str, Check]] = {
    "crossover.prob": ("crossover", "share of the pairs that are crossed, by SBX", _share),
    "crossover.prob_var": (
        "crossover_gene",
        "share of the coefficients that cross",
        _positive_share,
    ),
    "crossover.eta": ("crossover_eta", "how near to its parents a child is", _index),
    "mutation.prob": ("mutation", "share of the children that may mutate", _share),
    "mutation.prob_var": (
        "mutation_gene",
        "share of the coefficients that mutate; 1 / their number, at most 0.5, where it is not set",
        _share,
    ),
    "mutation.eta": ("mutation_eta", "how small a mutation is", _index),
    "normalize": ("normalise", "scale the objectives to the population", _yes_or_no),
    "n_neighbors": ("neighbours", "nearest directions that take a child", _count(2)),
    "prob_neighbor_mating": ("neighbour_mating", "share of the pairs that come from these", _share),
    "replaced": ("replaced", "most individuals that a child replaces", _count(1)),
    "mutation_eta": ("mutation_eta", "how small a mutation is", _index),
    "gradient_every": (
        "gradient_every",
        "generations between steps of the gradient",
        _count(1),
    ),
    "gradient_points": (
        "gradient_points",
        "candidates of the front that take them at a time",
        _count(2),
    ),
    "gradient_iterations": ("gradient_iterations", "iterations of each at a time", _count(1)),
    "step": ("step", "step of a difference, as a share of the bounds", _positive_share),
    "continuation": (
        "continuation",
        "start at the motion of the next larger limit, else at random",
        _yes_or_no,
    ),
    "first_step": (
        "first_step",
        "standard deviation at first, as a share of the bounds",
        _positive_share,
    ),
    "first": ("first", "candidates that are drawn at random before the others", _count(2)),
    "differences": ("differences", "share of the children that take a difference of two", _share),
    "training": ("training", "most candidates that a model is made of", _count(10)),
    "pool": ("pool", "random candidates among which the next one is chosen", _count(100)),
    "alpha": ("alpha", "how fast the penalty of an angle grows", positive),
    "adapt_freq": (
        "adaptation",
        "share of the generations between changes of the directions",
        _positive_share,
    ),
    "boundary": ("boundary", "what happens beyond the bounds", _one_of("clip", "reflect")),
    "velocity_limit": (
        "velocity_limit",
        "largest velocity of a coefficient, as a share of its bounds",
        positive,
    ),
    "max_velocity_rate": (
        "velocity_limit",
        "largest velocity of a coefficient, as a share of its bounds",
        positive,
    ),
    "archive_size": (
        "archive_size",
        "most points of the front; all are kept where it is not set",
        _count(2),
    ),
    "rule.inertia_start": (
        "inertia",
        "share of its velocity that a particle keeps at first",
        not_negative,
    ),
    "rule.inertia_end": ("last_inertia", "that share at the end", not_negative),
    "rule.constriction": ("constriction", "factor of every velocity", positive),
    "rule.cognitive": ("cognitive", "pull to its own best", not_negative),
    "rule.social": ("social", "pull to the next swarm's best", not_negative),
    "w": ("inertia", "share of its velocity that a particle keeps", not_negative),
    "c1": ("cognitive", "pull to its own best", not_negative),
    "c2": ("social", "pull to a point of the front", not_negative),
    "elite_size": ("elites", "particles that the others learn from", _count(1)),
    "mutation_rate": ("mutation", "share of the particles that may mutate", _share),
    "initial_velocity": ("first_velocity", "of the first population", _one_of("random", "zero")),
    "variant": ("variant", "which vectors differ, and how they cross", _variant),
    "CR": ("crossover", "share of the coefficients that cross", _share),
    "F": ("scale", "factor of a difference; random from 0 to 1 where it is not set", _scale),
    "gamma": ("jitter", "how much the factor differs between coefficients", not_negative),
    "de_repair": (
        "repair",
        "what happens beyond the bounds",
        _one_of("bounce-back", "midway", "rand-init", "to-bounds"),
    ),
    "delta": (
        "delta",
        "difference that is too small to dominate, as a share of the range",
        not_negative,
    ),
    "obj_crowding": ("objective_crowding", "spread the objectives", _yes_or_no),
    "var_crowding": ("coefficient_crowding", "spread the coefficients", _yes_or_no),
}
"""By the algorithm's own argument; ``crossover.eta`` is the crossover operator's ``eta``."""


@dataclass(frozen=True)
class MethodSetting:
    """A setting of a method; None as its default leaves it to the algorithm."""

    name: str
    argument: str
    default: Value
    meaning: str
    check: Check

    @classmethod
    def of(cls, argument: str, default: Value) -> MethodSetting:
        """The setting of an argument."""
        name, meaning, check = _ARGUMENTS[argument]
        return cls(name, argument, default, meaning, check)

    @classmethod
    def of_solver(cls, entry: Option) -> MethodSetting:
        """The setting of a method that is an option of its solver, as solver_tolerance."""
        argument = f"{NAME}.{entry.name}"

        def check(name: str, value: Any) -> Value:
            del name  # the option has words of its own
            return entry.checked(value)

        return cls(entry.setting, argument, entry.default, entry.meaning, check)

    @property
    def is_of_solver(self) -> bool:
        """Return whether this is an option of the method's solver, stated only if changed."""
        return self.argument.startswith(f"{NAME}.")


def with_defaults(
    method: str, known: tuple[MethodSetting, ...], settings: Mapping[str, object]
) -> dict[str, Value]:
    """All settings of a method: those that are given, each checked, and the defaults."""
    entries = {setting.name: setting for setting in known}
    for name in settings:
        if name not in entries:
            raise ValueError(has_no(method, "setting", str(name), entries))
    return {
        name: setting.check(name, settings[name]) if name in settings else setting.default
        for name, setting in entries.items()
    }
