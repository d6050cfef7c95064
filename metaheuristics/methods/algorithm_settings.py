"""Read the settings of an algorithm as plain numbers and words, for the record of a front."""

from __future__ import annotations

import hashlib
import inspect
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from pymoo.core.algorithm import Algorithm
from pymoo.core.variable import Variable


def settings_of(algorithm: Algorithm) -> dict[str, Any]:
    """Return the settings of a user's own algorithm that was not run yet."""
    renamed = {"pop_size": "population", "n_offsprings": "offspring"}
    operators = ("sampling", "selection", "crossover", "mutation", "survival", "decomposition")
    stated = getattr(algorithm, "settings", None)
    if isinstance(stated, Mapping):
        return dict(stated)
    base = vars(Algorithm()).keys()
    entries = {name: value for name, value in vars(algorithm).items() if name not in base}
    for holder in ("initialization", "mating"):
        entries = {**getattr(entries.get(holder), "__dict__", {}), **entries}
    settings: dict[str, Any] = {renamed.get(name, name): value for name, value in _plain(entries)}
    settings.update((name, _named(entries[name])) for name in operators if entries.get(name))
    directions = entries.get("ref_dirs")
    if isinstance(directions, np.ndarray):
        digest = hashlib.sha256(np.ascontiguousarray(directions, dtype=float).tobytes())
        settings["reference_directions"] = f"{len(directions)}, sha256 {digest.hexdigest()[:12]}"
    return settings


def _plain(entries: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """The entries that are numbers, words or functions; None is not set, or not a setting."""
    for name, value in sorted(entries.items()):
        value = value.value if isinstance(value, Variable) else value
        value = value.item() if isinstance(value, np.generic) else value
        value = value.__name__ if inspect.isfunction(value) else value
        value = str(value) if isinstance(value, tuple) else value
        if isinstance(value, str | int | float) and not name.startswith("_"):
            yield name, value


def _named(operator: Any) -> str:
    """An operator's class and numbers, such as SBX(eta=15, prob=0.9)."""
    if not hasattr(operator, "__dict__"):
        return str(operator)
    name = type(operator).__name__
    numbers = ", ".join(f"{k}={v}" for k, v in _plain(vars(operator)) if k != "name")
    return f"{name}({numbers})" if numbers else name
