"""The contest as one page of HTML that stands alone."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from quietarm.studies.contest.landscape import CANDIDATES, LEVEL, Landscape
from quietarm.studies.contest.measures import Arena, methods_in
from quietarm.studies.contest.names import label_of
from quietarm.studies.contest.report.citations import bibtex
from quietarm.studies.contest.report.figures import (
    anytime_figure,
    attainment_figure,
    looks_of,
    ranks_figure,
)
from quietarm.studies.contest.report.notes import missing_words, not_alike, unequal
from quietarm.studies.contest.report.paragraph import methods_paragraph, settings_lines
from quietarm.studies.contest.report.tables import (
    effects_table,
    summary_table,
    visits_table,
)
from quietarm.studies.contest.statistics import (
    ALPHA,
    Ranking,
    pairs_on,
    ranking_on,
    ranking_over,
    why_none,
)
from quietarm.studies.display.words import counted, millimetres, title_of
from quietarm.studies.report.document import (
    Block,
    Bullets,
    Document,
    Lines,
    Picture,
    Section,
    Text,
)

_ANYTIME = (
    "Share of the exact front's hypervolume that is missing, over evaluations and over time: "
    "medians over the seeds in bands of the quartiles; dotted the targets of 1 % and 0.1 %."
)
_ATTAINMENT = (
    "What half of the runs of each method attain, with the exact front in black; and where more "
    "runs of the best method (blue) or of another (red) attain residual and energy."
)
_RANKS = "Mean ranks, 1 the best; a bar joins methods that the tests do not tell apart."


def contest_document(arenas: Sequence[Arena], notes: Sequence[str] = ()) -> Document:
    """The contest: what was found, a section for each problem, how it was held."""
    methods = methods_in(arenas)
    title = f"{counted(len(methods), 'method')} against the exact front"
    sections = [_section(arena, methods) for arena in arenas]
    return Document(title, [*_findings(arenas, notes), *sections, _methods(arenas)])


def _findings(arenas: Sequence[Arena], notes: Sequence[str]) -> list[Block]:
    none, lines = why_none(arenas), list[str]()
    for arena in arenas:
        best = min(arena.alike, key=lambda one: one.middle)
        lines.append(
            f"{arena.problem}: {label_of(best.method)} ends nearest to the exact front, with "
            f"{missing_words(best, 'its')}."
        )
    lines += [f"{none}."] if none else []
    over = None if none else ranking_over(arenas)
    stated = [*unequal(arenas), *not_alike(arenas), *notes]
    lines += [line if line.endswith(".") else f"{line}." for line in stated]
    found = Bullets(lines, card=True)
    if over is None:
        return [found]
    words = f"{_RANKS} Over {over.blocks} problems, by medians. {_verdict(over)}"
    return [found, Picture("ranks.png", partial(ranks_figure, over, "all problems"), words)]


def _verdict(found: Ranking) -> str:
    says = "the methods differ" if found.differ else "no difference is shown"
    return (
        f"Friedman's test: chi2 = {found.statistic:.3g}, p = {found.p_value:.2g}, {says} at "
        f"{100 * ALPHA:g} %; Nemenyi's critical difference is {found.critical:.2f}."
    )


def _section(arena: Arena, methods: Sequence[str]) -> Section:
    title, looks = title_of(arena.yardstick.front.task), looks_of(methods)
    anytime, attainment = (
        Picture(
            f"{draw.__name__}.png", partial(draw, arena, looks), caption, f"{words} On {title}."
        )
        for draw, caption, words in (
            (anytime_figure, _anytime_words(arena), _ANYTIME),
            (attainment_figure, _ATTAINMENT, _ATTAINMENT),
        )
    )
    blocks = [
        Text(title, soft=True),
        anytime,
        summary_table(arena),
        attainment,
        *_statistics(arena),
        visits_table(arena),
        *([Bullets(explanation(arena.landscape))] if arena.landscape else []),
    ]
    return Section(arena.problem, blocks)


def _anytime_words(arena: Arena) -> str:
    if not arena.imports:
        return _ANYTIME
    names = " and ".join(label_of(one.method) for one in arena.imports)
    return f"{_ANYTIME} Of {names} only the end is known, so that there are no curves."


def explanation(found: Landscape) -> list[str]:
    """What makes a problem hard, in sentences."""
    level = millimetres(LEVEL)
    lines = [
        f"Of {found.starts} random starts in the box, the gradient ended at a minimum of the "
        f"energy within {level} from {100 * found.solved:.0f} %, and at the best of these from "
        f"{100 * found.best:.0f} %; {_minima_words(found.minima)}.",
        f"Over {CANDIDATES} random candidates, energy and distance to the cheapest motion "
        f"correlate by {found.candidates:.2f} (1 where better candidates lie nearer to it).",
    ]
    if found.correlation is not None:
        lines.append(
            f"Over the minima found, energy and distance to the best one correlate by "
            f"{found.correlation:.2f}."
        )
    for share, ratio in found.boxes:
        least = (
            f"no motion within {level} was found"
            if ratio is None
            else f"the least energy within {level} is {ratio:.4g} times that in this one"
        )
        lines.append(f"With a box {share:g} times as large {least}.")
    return lines


def _minima_words(number: int) -> str:
    if number == 1:
        return "all these minima have the same energy, to 0.1 %"
    return f"{number} of the minima differ by more than 0.1 % in energy"


def _statistics(arena: Arena) -> list[Block]:
    none = why_none([arena])
    if none:
        return [Text(f"{none[0].upper()}{none[1:]}.")]
    parts, found = list[Block](), ranking_on(arena)
    if found is not None:
        words = f"{_RANKS} Over {found.blocks} seeds. {_verdict(found)}"
        parts.append(Picture("ranks.png", partial(ranks_figure, found, arena.problem), words))
    return [*parts, effects_table(arena, pairs_on(arena))]


def _methods(arenas: Sequence[Arena]) -> Section:
    references = bibtex(methods_in(arenas), statistics=not why_none(arenas))
    blocks = [
        Text(methods_paragraph(arenas)),
        Bullets(settings_lines(arenas)),
        Section("References", [Lines(references.splitlines())]),
    ]
    return Section("Methods", blocks)
