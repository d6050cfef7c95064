"""BibTeX of what a contest used."""

from __future__ import annotations

from collections.abc import Iterable
from importlib.resources import files

from quietarm.metaheuristics.budget.run import MULTISTART, parts_of
from quietarm.studies.contest.names import is_own, method_in

_ALWAYS = ("casadi", "ipopt", "pymoo", "moocore", "numpy", "coco", "attainment")
_STATISTICS = ("scipy", "friedman", "demsar", "mannwhitney", "holm", "varghadelaney")


def bibtex(methods: Iterable[str], *, statistics: bool) -> str:
    """References to the methods, the software and the statistics of a contest."""
    from quietarm.metaheuristics import PRESETS

    entries, methods = _entries(), list(methods)
    searches = dict.fromkeys(parts_of(method_in(method))[0] for method in methods if is_own(method))
    elsewhere = [method for method in methods if not is_own(method)]
    keys = [*_ALWAYS, *(_STATISTICS if statistics else ())]
    unknown = [one for one in searches if one not in entries and one != MULTISTART]
    keys += [one for one in searches if one in entries]
    comments = [f"% {one}: see {PRESETS[one].source}" for one in unknown]
    comments += [f"% {one}: results from elsewhere" for one in elsewhere]
    return "\n\n".join([*(entries[key] for key in keys), *comments]) + "\n"


def _entries() -> dict[str, str]:
    text = (files("quietarm.studies.contest.report") / "references.bib").read_text(encoding="utf-8")
    entries = text.strip().split("\n\n")
    return {entry.partition("{")[2].partition(",")[0]: entry for entry in entries}
