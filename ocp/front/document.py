"""What of a file is taken for a front: every entry checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ocp.answers.documents import Document, made, profile_from_document, task_from_document
from ocp.base.checks import finite, not_negative, positive, whole
from ocp.front.points import FailedPoint, FrontPoint, Generation, Setting, non_dominated
from ocp.profiles.joint_profile import JointProfile


def front_from_document(document: Document) -> dict[str, Any]:
    """The arguments of `Front`, each checked.

    Parameters
    ----------
    document : dict
        What a file holds.

    Returns
    -------
    dict
        By name.

    Raises
    ------
    KeyError
        When an entry is missing.
    TypeError, ValueError
        When one has not the kind or the range that it has in a front.
    """
    profile = profile_from_document(document["profile"])
    points = tuple(_point(profile, entry) for entry in document["points"])
    if points != non_dominated(points):
        raise ValueError("its points are out of order, or one is better than another")
    residual, energy = _pair("reference", document["reference"])
    seed = document["seed"]
    counts = ("evaluations", "failed", "infeasible")
    return {
        "task": task_from_document(document["task"]),
        "profile": profile,
        "points": points,
        "method": _of_kind("method", document["method"], str),
        "settings": _table("settings", document["settings"], Setting),
        "seed": None if seed is None else whole("seed", seed, 0),
        "reference": (positive("reference", residual, "m"), positive("reference", energy, "J")),
        **{name: whole(name, document[name], 0) for name in counts},
        "failures": tuple(_failure(entry) for entry in document["failures"]),
        "gaps": tuple(_gap(entry) for entry in document["gaps"]),
        "history": tuple(_generation(entry) for entry in document["history"]),
        "complete": _of_kind("complete", document["complete"], bool),
        "versions": _table("versions", document["versions"], str),
        "seconds": not_negative("seconds", document["seconds"], "s"),
    }


def _point(profile: JointProfile, entry: Document) -> FrontPoint:
    return FrontPoint(
        profile.checked(entry["coefficients"]),
        not_negative("residual", entry["residual"], "m"),
        not_negative("energy", entry["energy"], "J"),
    )


def _generation(entry: Document) -> Generation:
    checked = made(Generation, entry)
    share = not_negative("hypervolume", checked.hypervolume)
    if share > 1:
        raise ValueError(f"hypervolume is {share:g}, and a share is at most 1")
    return Generation(whole("evaluations", checked.evaluations, 0), share)


def _failure(entry: Document) -> FailedPoint:
    asked = {str(name): finite("asked", value) for name, value in entry["asked"].items()}
    return FailedPoint(asked, _of_kind("reason", entry["reason"], str))


def _gap(entry: Sequence[float]) -> tuple[float, float]:
    begin, end = _pair("gap", entry)
    return not_negative("gap", begin, "m"), not_negative("gap", end, "m")


def _table(name: str, entries: Any, kind: Any) -> Mapping[str, Any]:
    """A table of values of one kind, not of further tables."""
    _of_kind(name, entries, dict)
    return {key: _of_kind(f"{name}: {key}", value, kind) for key, value in entries.items()}


def _pair(name: str, value: Any) -> Any:
    if len(_of_kind(name, value, list)) != 2:
        raise ValueError(f"{name} is {value!r}; give two numbers")
    return value


def _of_kind(name: str, value: Any, kind: Any) -> Any:
    if not isinstance(value, kind):
        raise ValueError(f"{name} is {value!r}, not of the kind it should be")
    return value
