"""The contest as a document, and what is written of it: page, tables, pictures, references."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from quietarm.ocp.files import write_whole
from quietarm.studies.contest.figures import (
    anytime_figure,
    attainment_figure,
    looks_of,
    ranks_figure,
)
from quietarm.studies.contest.measures import Arena, methods_in
from quietarm.studies.contest.sentences import (
    bibtex,
    explanation,
    findings,
    methods_paragraph,
    settings_lines,
    verdict,
)
from quietarm.studies.contest.statistics import (
    Ranking,
    pairs_on,
    ranking_on,
    ranking_over,
    why_none,
)
from quietarm.studies.contest.tables import (
    anytime_table,
    budgets_table,
    effects_table,
    over_table,
    pairs_table,
    ranks_table,
    runs_table,
    summary_table,
    visits_table,
)
from quietarm.studies.display.saving import File, drawing, inside
from quietarm.studies.display.words import counted, millimetres, title_of
from quietarm.studies.document.blocks import (
    Block,
    Bullets,
    Document,
    Lines,
    Picture,
    Section,
    Text,
)
from quietarm.studies.document.files import page
from quietarm.studies.document.table import Table

PAGE, REFERENCES, TABLES, FIGURES = "contest.html", "references.bib", "tables", "figures"
PLACES = (PAGE, REFERENCES, f"{TABLES}/any", f"{FIGURES}/any")
"""What is written into the folder of a contest beside its runs."""
_ANYTIME = (
    "Share of the exact front's hypervolume that is missing, over evaluations and over time: "
    "medians over the seeds in bands of the quartiles; dotted the targets of 1 % and 0.1 %."
)
_ATTAINMENT = (
    "What half of the runs of each method attain, with the exact front in black; and where more "
    "runs of the method that ends nearest (blue) or of another (red) attain residual and energy."
)
_RANKS = "Mean ranks, 1 the best; a bar joins methods that the tests do not tell apart."


def contest_document(arenas: Sequence[Arena], notes: Sequence[str] = ()) -> Document:
    """The contest: what holds over the problems, what was found, a section for each, how held."""
    methods, over = methods_in(arenas), _over(arenas)
    blocks: list[Block] = [over_table(arenas)] if len(arenas) > 1 else []
    blocks += [_ranks(over)] if over else []
    blocks.append(Bullets(findings(arenas, notes), card=True))
    references = bibtex(arenas).splitlines()
    how = [
        Text(methods_paragraph(arenas)),
        Bullets(settings_lines(arenas)),
        Section("References", [Lines(references)]),
    ]
    blocks += [*(section(arena, methods) for arena in arenas), Section("Methods", how)]
    title = f"{counted(len(methods), 'method')} against the exact front"
    return Document(title, blocks, {**_tables(arenas), "anytime": anytime_table(arenas)})


def results_document(arenas: Sequence[Arena], command: str) -> Document:
    """Methods on problems after parts of the evaluations, for a page that stays."""
    over, tables = _over(arenas), _tables(arenas)
    links = ", ".join(f"[{name}.csv]({name}.csv)" for name in tables)
    summary = [over_table(arenas).turned(), *([_ranks(over)] if over else [])]
    blocks: list[Block] = [
        Text(f"`{command}` makes this page anew. Running times, tests and every run: {links}."),
        *([Section("Over all problems", summary)] if len(arenas) > 1 else []),
        *(
            Section(arena.problem, [budgets_table(arena).turned(), *_why(arena)])
            for arena in arenas
        ),
        Section("Methods", [Text(methods_paragraph(arenas)), Bullets(settings_lines(arenas))]),
    ]
    title = f"{counted(len(methods_in(arenas)), 'method')} on {counted(len(arenas), 'problem')}"
    return Document(title, blocks, tables)


def _over(arenas: Sequence[Arena]) -> Ranking | None:
    return None if why_none(arenas) else ranking_over(arenas)


def _tables(arenas: Sequence[Arena]) -> dict[str, Table]:
    """Every run; and where there are enough of them, pairs of methods and ranks."""
    if why_none(arenas):
        return {"runs": runs_table(arenas)}
    rankings = [*map(ranking_on, arenas), _over(arenas)]
    return {
        "runs": runs_table(arenas),
        "pairs": pairs_table([pair for arena in arenas for pair in pairs_on(arena)]),
        "ranks": ranks_table([found for found in rankings if found]),
    }


def section(arena: Arena, methods: Sequence[str]) -> Section:
    """What was found on a problem."""
    title, looks = title_of(arena.yardstick.front.task), looks_of(methods)
    anytime, names = _ANYTIME, " and ".join(field.label for field in arena.imports)
    if names:
        anytime += f" Of {names} only the end is known, so that there are no curves."
    drawn = [
        Picture(
            f"{name}-{arena.problem}.png",
            partial(draw, arena, looks),
            caption,
            f"{words} On {title}.",
        )
        for name, draw, caption, words in (
            ("anytime", anytime_figure, anytime, _ANYTIME),
            ("attainment", attainment_figure, _ATTAINMENT, _ATTAINMENT),
        )
    ]
    none = why_none([arena])
    found = None if none else ranking_on(arena)
    blocks: list[Block] = [
        Text(title, soft=True),
        drawn[0],
        budgets_table(arena),
        summary_table(arena),
        drawn[1],
        *([_ranks(found)] if found else []),
        Text(f"{none[0].upper()}{none[1:]}.") if none else effects_table(arena, pairs_on(arena)),
        visits_table(arena),
        *_why(arena),
    ]
    return Section(arena.problem, blocks)


def _why(arena: Arena) -> list[Block]:
    """What makes the problem hard, where that was looked for."""
    if not arena.yardstick.within_level:
        stillest = arena.yardstick.front.stillest()
        return [Bullets([f"No motion is stiller than {millimetres(stillest.residual)}."])]
    return [Bullets(explanation(arena.landscape))] if arena.landscape else []


def _ranks(found: Ranking) -> Picture:
    name = f"ranks-{found.on.replace(' ', '-')}.png"
    words = f"{_RANKS} Over {found.over}. {verdict(found)}"
    return Picture(name, partial(ranks_figure, found), words)


def report_files(arenas: Sequence[Arena], folder: Path, notes: Sequence[str] = ()) -> list[File]:
    """The page, every table as CSV, every picture as PNG and PDF; and what writes each."""
    document = contest_document(arenas, notes)
    references = bibtex(arenas)
    tables = {f"{name}.csv": table.save_csv for name, table in document.data.items()}
    pictures = {
        picture.name.replace(".png", suffix): drawing(picture.draw)
        for picture in document.pictures
        for suffix in (".png", ".pdf")
    }
    return [
        (folder / PAGE, lambda path: write_whole(path, page(document))),
        (folder / REFERENCES, lambda path: write_whole(path, references)),
        *inside(folder / TABLES, tables),
        *inside(folder / FIGURES, pictures),
    ]
