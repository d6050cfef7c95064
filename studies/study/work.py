"""The work of a study: every method on every case, compared with each other and the floor."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from quietarm.metaheuristics.sharing.pieces import INTERRUPTED, Done, Listener, Piece
from quietarm.metaheuristics.sharing.running import run_pieces
from quietarm.metaheuristics.sharing.workers import Workers
from quietarm.ocp import Floor, Front, Polish, QuietarmError, SolverFailedError
from quietarm.ocp.base.interrupts import note_interrupts
from quietarm.studies.comparison.measures import Comparison, compare_fronts
from quietarm.studies.display.words import title_of
from quietarm.studies.paper.case import Case
from quietarm.studies.paper.points import PaperPoint, paper_points
from quietarm.studies.paper.printed import CONDITIONS
from quietarm.studies.registry.methods import METHODS
from quietarm.studies.study.pieces import FLOOR, Key, StudySettings, pieces_of


@dataclass(frozen=True, eq=False)
class CaseStudy:
    """What a study found for one task."""

    case: Case
    comparison: Comparison
    polishes: Mapping[str, Polish]
    floor: Floor | None
    paper: tuple[PaperPoint, ...]
    failures: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Study:
    """A study of one task or several."""

    settings: StudySettings
    cases: tuple[CaseStudy, ...]
    seconds: float
    done: int | None = None
    stopped: str = ""


def amount_of_work(cases: Sequence[Case], settings: StudySettings) -> int:
    """How many pieces of work `run_study` begins."""
    return sum(len(pieces_of(case, settings)) for case in cases)


def run_study(
    cases: Sequence[Case] = CONDITIONS,
    settings: StudySettings | None = None,
    begin: Callable[[str], None] = lambda name: None,
) -> Study:
    """Run every method on every case and compare what they find."""
    began = time.perf_counter()
    settings = StudySettings() if settings is None else settings
    for front in settings.fronts:
        if all(front.task != case.task for case in cases):
            where = title_of(front.task)
            raise ValueError(
                f"the front by {front.method} is of another task, {where}; leave it out, or give "
                "the task that it is of"
            )
    pieces = [piece for case in cases for piece in pieces_of(case, settings)]
    where = Workers(settings.workers, settings.scheduler)
    done = run_pieces(pieces, Listener(begin), workers=where, note=QuietarmError)
    found: list[CaseStudy] = []
    with note_interrupts():  # what was found is put together to the end
        for case in cases:
            found += _case_study(case, settings, done)
    floors = [words for case in cases for words in _floor_words(case, done)]
    if not found and floors:
        raise QuietarmError(f"{done.stopped} before there was a front; {'; '.join(floors)}")
    if not found and done.stopped == INTERRUPTED:
        raise KeyboardInterrupt
    if not found:
        raise QuietarmError(f"{done.stopped}; nothing was found before")
    number = done.number if done.stopped else None
    return Study(settings, tuple(found), time.perf_counter() - began, number, done.stopped)


def _case_study(case: Case, settings: StudySettings, done: Done) -> list[CaseStudy]:
    """What was found for a case, if anything was before the work was stopped."""
    pieces = pieces_of(case, settings)
    fronts = [front for piece in pieces for front in _fronts_of(piece, done) if front.points]
    failures = _what_is_missing(pieces, done)
    if not fronts and done.stopped:
        return []
    fronts += [front for front in settings.fronts if front.task == case.task]
    if len(fronts) < 2 and not done.stopped:
        where = title_of(case.task)
        why = "; ".join([*failures, *_floor_words(case, done)])
        raise SolverFailedError(f"{where}: no two fronts to compare; {why}")
    floor = _found(Key(case, FLOOR), done)
    polishes = {
        m.name: done.answers.get(Key(case, m.then_polished().name)) for m in METHODS.values()
    }
    study = CaseStudy(
        case=case,
        comparison=compare_fronts(fronts, floor=None if floor is None else floor.energy, least=1),
        polishes={name: polish for name, polish in polishes.items() if polish is not None},
        floor=floor,
        paper=tuple(paper_points(case.task, {settings.terms})),
        failures=tuple(failures),
    )
    return [study]


def _floor_words(case: Case, done: Done) -> list[str]:
    """The floor of a case in words, where it was found: without a front there is no page for it."""
    floor = _found(Key(case, FLOOR), done)
    return [] if floor is None else [f"floor of {title_of(case.task)}: {floor.energy:.6g} J"]


def _found(key: Hashable, done: Done) -> Any:
    """What a piece found, whole or in part; None where it found nothing."""
    return done.answers.get(key, done.parts.get(key))


def _fronts_of(piece: Piece, done: Done) -> list[Front]:
    """The front that a piece found, whole or in part."""
    found = _found(piece.key, done)
    if isinstance(found, Polish):
        return [found.front]
    return [found] if isinstance(found, Front) else []


def _what_is_missing(pieces: Sequence[Piece], done: Done) -> list[str]:
    """What did not come to its end, and why: a line for each method and reason."""
    names = [piece.key.name for piece in pieces if isinstance(piece.key, Key)]
    troubles = Counter(zip(names, (_trouble(piece, done) for piece in pieces), strict=True))
    lines = list[str]()
    for (name, trouble), count in troubles.items():
        seeds = f" ({count} of {names.count(name)} seeds)" if names.count(name) > 1 else ""
        if trouble:
            lines.append(f"{name}{seeds}: {trouble}")
    return lines


def _trouble(piece: Piece, done: Done) -> str:
    """Why the answer of a piece is missing; empty where it is not."""
    if piece.key in done.failures:
        return str(done.failures[piece.key])
    if piece.key in done.parts:
        return "interrupted, with what was found until then"
    if piece.key not in done.answers:
        return "not done before the interruption"
    return "found no point" if any(not f.points for f in _fronts_of(piece, done)) else ""
