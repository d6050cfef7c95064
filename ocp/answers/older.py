"""What files of older versions held, in the shape of today's.

Each function takes a document and returns one; what is missing or wrong in it raises KeyError,
TypeError, ValueError or AttributeError.
"""

from __future__ import annotations

from ocp.answers.documents import Document

_TASK = ("plant", "plant_parameters", "start", "target", "duration", "residual_window", "limits")
_SHARED, _SOLVERS = ("residual_limit", "bound", "seed"), ("starts", "steps", "guess")
"""Settings that the gradient shares with a search, and its own."""


def plan_of_version_1(document: Document) -> Document:
    """A plan whose task stood among the rest, and its figures in two places."""
    provenance = dict(document["provenance"])
    method, settings = provenance["method"], provenance["settings"]
    solver, search = None, settings
    if method.endswith("ipopt"):  # alone, or after a search
        solver = {name: settings.get(name) for name in (*_SHARED, *_SOLVERS)}
        if solver["guess"] is not None:
            solver["guess"] = [float(value) for value in solver["guess"].split(",")]
        search = {name: settings[name] for name in settings if name not in _SOLVERS}
    if method == "ipopt":
        search = {}
    return {
        "task": task_with_limits_apart(document),
        **{name: document[name] for name in ("profile", "coefficients")},
        "motion": {
            "residual": document["residual"], "energy": document["energy"],
            **document["diagnostics"],
        },
        **{name: document[name] for name in ("status", "verification")},
        "provenance": {**provenance, "settings": solver, "search": search},
    }  # fmt: skip


def front_of_version_2(document: Document) -> Document:
    """A front that counted candidates and iterations as one number."""
    counted, history = document["evaluations"], document["history"]
    searched = document["method"].partition(",")[0] not in ("epsilon", "weighted")
    polished = document["method"].endswith(", polished")
    evaluations = counted if searched else 0
    if searched and polished and history:
        evaluations = history[-1]["evaluations"]
    return {
        **document,
        "task": task_with_limits_apart(document["task"]),
        "evaluations": evaluations,
        "iterations": counted - evaluations,
    }


def floor_of_version_1(document: Document) -> Document:
    """A floor whose task stood among the rest."""
    rest = {name: entry for name, entry in document.items() if name not in _TASK}
    return {
        "task": task_with_limits_apart(document),
        "free": rest.pop("motion"),
        "motion": rest.pop("figures"),
        "provenance": {**rest.pop("provenance"), "search": {}},
        **rest,
    }


def checkpoint_of_version_1(document: Document) -> Document:
    """A checkpoint whose header had all of a search side by side."""
    rest = {name: entry for name, entry in document.items() if name not in _TASK}
    return {
        "versions": rest.pop("versions"),
        "search": {**rest, "task": task_with_limits_apart(document)},
    }


def task_with_limits_apart(document: Document) -> Document:
    """The task among the entries of a document that had its limits in a table of their own."""
    return {
        "plant": {"name": document["plant"], **document["plant_parameters"]},
        **{name: document[name] for name in ("start", "target", "duration", "residual_window")},
        **{f"{name}_limit": limit for name, limit in document["limits"].items()},
    }
