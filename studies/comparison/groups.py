"""Which fronts may be compared, and which are runs of the same method."""

from __future__ import annotations

import json
import reprlib
from collections.abc import Sequence

from quietarm.ocp import Front
from quietarm.ocp.answers.documents import plain
from quietarm.ocp.front.robust import EXCESS
from quietarm.studies.paper.tasks import task_difference
from quietarm.studies.registry.methods import method_of


def checked_names(names: Sequence[str], fronts: int) -> list[str]:
    """What to call each of so many fronts."""
    given = list(names)
    if given and len(given) != fronts:
        raise ValueError(f"names are {reprlib.repr(given)}; give one for each of {fronts} fronts")
    return given or [f"front {i}" for i in range(1, fronts + 1)]


def check_fronts(
    fronts: Sequence[Front], names: Sequence[str], *, twice: bool = False, least: int = 2
) -> None:
    """Refuse fronts that cannot be compared."""
    if len(fronts) < least:
        raise ValueError(f"a comparison takes two fronts or more; {len(fronts)} given: give more")
    for front, name in zip(fronts, names, strict=True):
        if not front.points:
            raise ValueError(f"{name} has no finite point; leave it out, or search longer")
        difference = task_difference(front.task, fronts[0].task)
        if difference:
            raise ValueError(
                f"{name} is of another task than {names[0]}: its {difference}; compare fronts of "
                "one task"
            )
    for i, front in enumerate(fronts):
        if not twice and front in fronts[:i]:
            first = names[list(fronts).index(front)]
            raise ValueError(f"{name_of_twin(names[i], first)}; give every front once")
        if not twice and names[i] in names[:i]:
            raise ValueError(f"{names[i]!r} is the name of two fronts; give each one of its own")


def name_of_twin(name: str, first: str) -> str:
    """Two names of one front, in words."""
    return f"{name} is given twice" if name == first else f"{name} is the same front as {first}"


def grouped(fronts: Sequence[Front]) -> dict[str, list[int]]:
    """Which fronts are runs of one method with one set of settings."""
    groups: dict[str, list[int]] = {}
    for i, front in enumerate(fronts):
        groups.setdefault(json.dumps([front.method, _settings(front)], sort_keys=True), []).append(
            i
        )
    firsts = [fronts[members[0]] for members in groups.values()]
    return {
        _label(front, [o for o in firsts if o.method == front.method]): members
        for front, members in zip(firsts, groups.values(), strict=True)
    }


def _settings(front: Front) -> dict[str, object]:
    profile = plain(front.profile)
    asked = {name: value for name, value in front.settings.items() if name != EXCESS}
    return {**asked, "profile": profile.pop("name"), **profile, "whole": front.complete}


def _label(front: Front, alike: Sequence[Front]) -> str:
    """The method, with the settings in which it differs from others of the same method."""
    words = [method_of(front.method).label]
    for name, value in _settings(front).items():
        others = [_settings(other).get(name) for other in alike]
        if any(other != value for other in others):
            if name == "whole":
                words += [] if value else ["interrupted"]
            elif value is None:
                words.append(f"no {name}")
            else:
                shown = f"{value:g}" if isinstance(value, float) else str(value)
                words.append(f"{name} {shown}")
    return ", ".join(words)
