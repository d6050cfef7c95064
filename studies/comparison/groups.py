"""Which fronts may be compared, and which are runs of the same method."""

from __future__ import annotations

import json
from collections.abc import Sequence

from quietarm.ocp import Front
from quietarm.ocp.answers.documents import plain
from quietarm.studies.paper.tasks import task_difference
from quietarm.studies.registry.methods import method_of


def check_alike(fronts: Sequence[Front], names: Sequence[str]) -> None:
    """Refuse fronts without points, or of several tasks."""
    for front, name in zip(fronts, names, strict=True):
        if not front.points:
            raise ValueError(f"{name} has no finite point; leave it out, or search longer")
        difference = task_difference(front.task, fronts[0].task)
        if difference:
            raise ValueError(
                f"{name} is of another task than {names[0]}: its {difference}; compare fronts of "
                "one task"
            )


def check_apart(fronts: Sequence[Front], names: Sequence[str]) -> None:
    """Refuse a front that is given twice, and two of one name."""
    for i, (front, name) in enumerate(zip(fronts, names, strict=True)):
        if front in fronts[:i]:
            first = names[list(fronts).index(front)]
            twin = "given twice" if name == first else f"the same front as {first}"
            raise ValueError(f"{name} is {twin}; give every front once")
        if name in names[:i]:
            raise ValueError(f"{name!r} is the name of two fronts; give each one of its own")


def grouped(fronts: Sequence[Front]) -> dict[str, list[int]]:
    """Which fronts are runs of one method with one set of settings."""
    groups: dict[str, list[int]] = {}
    for i, front in enumerate(fronts):
        key = json.dumps([front.method, _settings(front)], sort_keys=True)
        groups.setdefault(key, []).append(i)
    firsts = [fronts[members[0]] for members in groups.values()]
    return {
        _label(front, [other for other in firsts if other.method == front.method]): members
        for front, members in zip(firsts, groups.values(), strict=True)
    }


def _settings(front: Front) -> dict[str, object]:
    profile = plain(front.profile)
    return {**front.settings, "profile": profile.pop("name"), **profile, "whole": front.complete}


def _label(front: Front, alike: Sequence[Front]) -> str:
    """The method, with the settings in which it differs from others of the same method."""
    words, others = [method_of(front.method).label], [_settings(other) for other in alike]
    for name, value in _settings(front).items():
        if all(other.get(name) == value for other in others):
            continue
        if name == "whole":
            words += [] if value else ["interrupted"]
        else:
            shown = f"{value:g}" if isinstance(value, float) else str(value)
            words.append(f"no {name}" if value is None else f"{name} {shown}")
    return ", ".join(words)
