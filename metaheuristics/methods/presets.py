"""The methods that are known by name: one entry of presets.toml each."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from quietarm.metaheuristics.methods.preset import Preset
from quietarm.metaheuristics.methods.search_method import SearchMethod
from quietarm.metaheuristics.methods.settings import Value
from quietarm.metaheuristics.named_method import NamedMethod
from quietarm.ocp.checks import known, unknown

PAPER_BOX: dict[str, float] = {"single-link": 0.2, "arm-on-flexible-link": 0.5}
"""Largest absolute coefficient in the paper's searches, by plant, of eqs (12) and (17)."""
_UNSET = "unset"
"""In place of a number that is left to the algorithm."""


def preset_of(name: str) -> Preset:
    """A method by its name; ValueError suggests the nearest one."""
    named = NamedMethod.read(name)
    if named.by_gradient:
        raise ValueError(
            f"{name} is no search: it takes the gradient of a plant's model; give a search, such "
            f"as 'nsga2', or find the front of a move by epsilon_front or weighted_front"
        )
    if named.polish and named.method in PRESETS:
        raise ValueError(
            f"{name} is the name of a job; give {named.method!r}, and its front to polish_front"
        )
    if name not in PRESETS:
        raise ValueError(unknown("method", name, PRESETS))
    return PRESETS[name]


def _read_presets() -> dict[str, Preset]:
    text = Path(__file__).with_suffix(".toml").read_text(encoding="utf-8")
    presets = dict[str, Preset]()
    for name, entries in tomllib.loads(text).items():
        defaults = dict(_arguments(entries.pop("defaults", {})))
        presets[name] = Preset(name=name, defaults=defaults, **entries)
    return presets


def _arguments(defaults: Mapping[str, Any]) -> Iterator[tuple[str, Value]]:
    """The default of every argument, of an operator's as crossover.eta."""
    for name, value in defaults.items():
        if isinstance(value, Mapping):
            yield from ((f"{name}.{argument}", entry) for argument, entry in _arguments(value))
        else:
            yield name, None if value == _UNSET else value


class Presets(Mapping[str, Preset]):
    """Every method by its name: quietarm's, and then those of the user's own classes.

    ValueError where one of these has the name of quietarm's.
    """

    _shipped: Mapping[str, Preset] = _read_presets()

    def _all(self) -> Mapping[str, Preset]:
        own = known(SearchMethod)
        for name, kind in own.items():
            if name in self._shipped:
                raise ValueError(
                    f"name {name!r} of the search {kind.__name__} is quietarm's own; give another"
                )
        return {**self._shipped, **{name: _of_own(kind) for name, kind in own.items()}}

    def __getitem__(self, name: str) -> Preset:
        return self._shipped[name] if name in self._shipped else self._all()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._all())

    def __len__(self) -> int:
        return len(self._all())


@cache
def _of_own(kind: type[SearchMethod]) -> Preset:
    """The one entry of a class."""
    return Preset.of_own(kind)


PRESETS: Mapping[str, Preset] = Presets()
"""By name."""
