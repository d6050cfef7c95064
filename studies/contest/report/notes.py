"""What is to be known of the runs of a contest, in sentences."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from quietarm.studies.contest.imported import Imported
from quietarm.studies.contest.measures import Arena, Outcome
from quietarm.studies.contest.names import label_of
from quietarm.studies.contest.report.tables import evaluations_words
from quietarm.studies.contest.runs import Run

_THE_EXACT = "the exact front's"


def not_alike(arenas: Sequence[Arena]) -> list[str]:
    """Results from elsewhere that are shown and not compared by tests, and why, in sentences."""
    return [
        f"{arena.problem}: {label_of(one.method)} ends with {missing_words(one, _THE_EXACT)}. "
        f"It does not compare: its evaluations are {evaluations_words(one)}, those of the others "
        f"{' or '.join(sorted({evaluations_words(field) for field in arena.fields}))}."
        for arena in arenas
        for one in arena.imports
        if one not in arena.alike
    ]


def unequal(arenas: Sequence[Arena]) -> list[str]:
    """What is to be known of runs that are not as many, as long or of the same versions."""
    lines = list[str]()
    for arena in arenas:
        counts = {len(field.runs) for field in arena.fields}
        if len(counts) > 1:
            stated = ", ".join(f"{label_of(f.method)} {len(f.runs)}" for f in arena.fields)
            lines.append(f"{arena.problem}: the methods have unequal numbers of runs: {stated}.")
        short = [f for f in arena.fields for run in f.runs if run.front.evaluations < run.budget]
        lines += [
            f"{arena.problem}: {label_of(field.method)} ended before its evaluations were spent."
            for field in dict.fromkeys(short)
        ]
        versions = versions_of(run for field in arena.fields for run in field.runs)
        mixed = [f"{name} {' and '.join(known)}" for name, known in versions.items()
                 if len(known) > 1]  # fmt: skip
        if mixed:
            lines.append(
                f"{arena.problem}: the runs are of different versions: {', '.join(mixed)}."
            )
    return lines


def wrong_claims(arenas: Sequence[Arena]) -> list[str]:
    """What files from elsewhere state otherwise than their coefficients give, in words."""
    return [
        f"{run.words}: {claim}"
        for arena in arenas
        for one in arena.imports
        for run in one.runs
        if isinstance(run, Imported)
        for claim in run.claims
    ]


def missing_words(one: Outcome, whose: str) -> str:
    """What the middle run has not found, in words."""
    runs = f"the middle run of {len(one.runs)}" if len(one.runs) > 1 else "its only run"
    return f"{100 * one.middle:.3g} % of {whose} hypervolume missing in {runs}"


def versions_of(runs: Iterable[Run]) -> dict[str, list[str]]:
    """The versions of everything that computed runs."""
    found: dict[str, set[str]] = {}
    for run in runs:
        for name, version in run.front.versions.items():
            found.setdefault(name, set()).add(version)
    return {name: sorted(known) for name, known in found.items()}
