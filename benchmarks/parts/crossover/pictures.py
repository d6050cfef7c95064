"""The pictures of the page, from the figures of recompute.py alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from quietarm.views.pictures import grammar, stack
from quietarm.views.pictures.axes import NARROW, TITLE, broken_into_lines, head
from quietarm.views.pictures.grammar import Look

from .verdicts import verdicts
from .words import RANDOM_STARTS, short_label, spelled_budget, two_digits, without_noise

WAYS = (
    ("points, to its end", "50 points each, the gradient to its end"),
    ("points, same time", "50 points each, in the search's time"),
    ("between, to its end", "with motions between, the gradient to its end"),
    ("between, same time", "with motions between, in the search's time"),
)
VALUES = (
    ("points, differences", "50 points each, SLSQP with as many candidates"),
    ("between, differences", "with motions between, SLSQP with as many candidates"),
)
SMALL = 9.5
"""Letters of a cell: they are read on a page that is 1400 pixels wide."""
MOST_DECADES = 1.5
"""A ratio of this many decades has the darkest colour."""
NORM = TwoSlopeNorm(0.0, -MOST_DECADES, MOST_DECADES)
DIVERGING = LinearSegmentedColormap.from_list(
    "search or gradient", [grammar.SEARCH.colour, "white", grammar.PLAN.colour]
)
"""Of a cell, by who is better: as the lines of a search and of the gradient."""
NO_FRONT = grammar.FAINT
"""Of a cell where the gradient has no front yet on most moves, so that nothing is compared."""
FURTHER = grammar.looks([""] * 5)
"""Looks of methods that are neither the gradient nor the best search."""
LOOK_OF: Mapping[str, Look] = {
    "gradient": grammar.PLAN,
    **dict(
        zip(
            ("gradient, 50 points", "gradient, 10 points", "multistart"),
            grammar.variants("plan", 3),
        )
    ),
    **dict(zip(("MOEA/D-DE", "MOEA/D-DE, up to five evaluations"), grammar.variants("search", 2))),
    **dict(zip(("memetic MOEA/D-DE", "SLSQP", "MO-CMA-ES", "NSGA-II", "GDE3"), FURTHER)),
}
"""Of the methods that several pictures have."""


PROFILED = ("best of all", "slsqp", "moead-de", "mo-cma-es", "gde3", "nsga2")
"""What the picture of runtime profiles shows."""


def write_pictures(figures: Mapping[str, Any], folder: Path) -> None:
    """All pictures of a page."""
    drawn = {
        "map.png": map_figure(figures["map"], WAYS[2:], "gradient"),
        "ways.png": map_figure(figures["map"], WAYS, "gradient"),
        "values.png": map_figure(figures["map"], VALUES, "SLSQP"),
        "coefficients.png": coefficients_figure(figures["map_rows"]),
        "budget.png": budget_figure(figures["map_rows"]),
        "attained.png": attained_figure(figures["attained"]),
        "kinds.png": kinds_figure(figures["kinds"]),
        "features.png": features_figure(figures["prediction"]),
    }
    if len(figures["profiles"]["shares"]) == 2:
        drawn["profiles.png"] = profiles_figure(figures["profiles"])
    if any(figures["noise"].values()):
        drawn["noise.png"] = noise_figure(figures["noise"])
    for_phones = {
        "map.png": narrow_map_figure(figures["map"], WAYS[2:], "gradient"),
        "ways.png": narrow_map_figure(figures["map"], WAYS, "gradient"),
        "values.png": narrow_map_figure(figures["map"], VALUES, "SLSQP"),
    }
    for name, figure in drawn.items():
        if figure is not None:
            _save(figure, folder / name, for_phones.get(name) or stack(figure))


def _save(figure: Figure, path: Path, for_phones: Figure | None) -> None:
    """Write a picture, and beside it the one for phones."""
    without_versions = {"Software": ""}
    figure.savefig(path, dpi=110, metadata=without_versions)
    if for_phones is not None:
        narrow = path.with_name(f"{path.stem}-narrow.png")
        for_phones.savefig(narrow, dpi=150, metadata=without_versions)


def new_figure(width: float, height: float) -> Figure:
    """With room for labels."""
    return Figure(figsize=(width, height), layout="constrained")


def map_figure(
    cells: Sequence[Mapping[str, Any]], ways: Sequence[tuple[str, str]], rival: str
) -> Figure:
    """Coefficients by budget: orange where a search is better, blue where its rival is."""
    figure = new_figure(11.0, 1.1 + 3.4 * len(ways))
    _head_of_map(figure, cells, ways, rival)
    axes = figure.subplots(len(ways), 1, sharex=True, squeeze=False)
    terms = sorted({cell["terms"] for cell in cells})
    budgets = sorted({cell["budget"] for cell in cells})
    for ax, (way, title) in zip(axes.flat, ways, strict=True):
        for cell in cells:
            corner = (terms.index(cell["terms"]), budgets.index(cell["budget"]))
            draw_cell(ax, corner, cell["ways"].get(way), rival)
        ax.set(
            xlim=(0, len(terms)),
            ylim=(0, len(budgets)),
            xticks=np.arange(len(terms)) + 0.5,
            xticklabels=terms,
            yticks=np.arange(len(budgets)) + 0.5,
            yticklabels=[spelled_budget(budget) for budget in budgets],
        )
        ax.set_title(title, **TITLE)
        ax.tick_params(length=0)
    for ax in axes[-1]:
        ax.set_xlabel("coefficients")
    for ax in axes[:, 0]:
        ax.set_ylabel("candidates")
    bar = figure.colorbar(_scale_of_map(), ax=axes, shrink=0.6, ticks=[-1, 0, 1])
    words = ["search: a tenth\nof the gap", "alike", "search: ten\ntimes the gap"]
    bar.ax.set_yticklabels(words, fontsize=SMALL)
    return figure


def narrow_map_figure(
    cells: Sequence[Mapping[str, Any]], ways: Sequence[tuple[str, str]], rival: str
) -> Figure:
    """Draw the map for a phone: panels below each other, budget by coefficients in higher cells."""
    figure = new_figure(NARROW, 2.2 + 5.9 * len(ways))
    _head_of_map(figure, cells, ways, rival)
    axes = figure.subplots(len(ways), 1, squeeze=False)[:, 0]
    terms = sorted({cell["terms"] for cell in cells})
    budgets = sorted({cell["budget"] for cell in cells})
    for ax, (way, title) in zip(axes, ways, strict=True):
        for cell in cells:
            corner = (budgets.index(cell["budget"]), terms.index(cell["terms"]))
            draw_cell(ax, corner, cell["ways"].get(way), rival)
        ax.set(
            xlim=(0, len(budgets)),
            ylim=(len(terms), 0),  # few coefficients above
            xticks=np.arange(len(budgets)) + 0.5,
            xticklabels=[spelled_budget(budget) for budget in budgets],
            yticks=np.arange(len(terms)) + 0.5,
            yticklabels=terms,
            xlabel="candidates",
            ylabel="coefficients",
        )
        title_of_panel = ax.set_title(title, **TITLE)
        title_of_panel.set_text(broken_into_lines(title, NARROW - 0.6, TITLE["fontsize"]))
        ax.tick_params(length=0)
    bar = figure.colorbar(
        _scale_of_map(), ax=list(axes), location="bottom", ticks=[-1, 0, 1], fraction=0.02,
        aspect=25, pad=0.01,
    )  # fmt: skip
    words = ["search: a tenth\nof the gap", "alike", "search: ten\ntimes the gap"]
    bar.ax.set_xticklabels(words, fontsize=8)
    return figure


def _head_of_map(
    figure: Figure, cells: Sequence[Mapping[str, Any]], ways: Sequence[tuple[str, str]], rival: str
) -> None:
    """Say who is better in how many cells, and what the cells show."""
    head(
        figure,
        _counted(cells, ways, rival),
        f"Hypervolume gaps of the best search and of {_the(rival)}; medians over moves. "
        "Lines: not significant; dots: too few moves",
    )


def _scale_of_map() -> matplotlib.cm.ScalarMappable:
    """The scale of the cells' colours."""
    return matplotlib.cm.ScalarMappable(NORM, DIVERGING)


def _counted(
    cells: Sequence[Mapping[str, Any]], ways: Sequence[tuple[str, str]], rival: str
) -> str:
    """Count the cells in which the rival is better, and a search, with a verdict."""

    def better(side: str, ending: str) -> int:
        return sum(len(verdicts(cells, way)[side]) for way, _ in ways if way.endswith(ending))

    alike = sum(way.endswith(ways[0][0].partition(", ")[2]) for way, _ in ways)
    total = alike * verdicts(cells, ways[0][0])["run"]
    if rival != "gradient":
        return (
            f"{rival} is better in {better('gradient', '')} of {total} cells, "
            f"a search in {better('search', '')}"
        )
    return (
        f"The gradient is better in {better('gradient', 'end')} of {total} cells if it runs to its "
        f"end, a search in {better('search', 'end')}; in the search's time in "
        f"{better('gradient', 'time')} and {better('search', 'time')}"
    )


def _the(rival: str) -> str:
    """Name what a search is compared with, as a subject."""
    return "the gradient" if rival == "gradient" else rival


def draw_cell(
    ax: Axes,
    corner: tuple[int, int],
    row: Mapping[str, Any] | None,
    rival: str,
) -> None:
    """The gaps of the best search and its rival; hatched or dotted without a verdict."""
    if row is None:
        ax.add_patch(Rectangle(corner, 1, 1, facecolor=grammar.PALE, edgecolor="white"))
        middle(ax, corner, "not run", grammar.INK)
        return
    name = short_label(row["method"]).replace(" of ", "\nof ")
    text = f"{name}\n{two_digits(row['missing'])} %\n{rival}\n"
    if row["no_front"]:
        ax.add_patch(Rectangle(corner, 1, 1, facecolor=NO_FRONT, edgecolor="white"))
        middle(ax, corner, f"{text}no front yet", "black")
        return
    colour = DIVERGING(NORM(np.clip(row["log_ratio"], -MOST_DECADES, MOST_DECADES)))
    ax.add_patch(Rectangle(corner, 1, 1, facecolor=colour, edgecolor="white"))
    if not row["verdict"]:
        hatch = "////" if row["enough"] else "...."
        pattern: dict[str, Any] = {"fill": False, "edgecolor": grammar.GREY, "linewidth": 0}
        ax.add_patch(Rectangle(corner, 1, 1, hatch=hatch, **pattern))
    dark = row["log_ratio"] > 0.6 * MOST_DECADES and row["verdict"]
    theirs = f"{two_digits(row['control'])} %"
    middle(ax, corner, text + theirs, "white" if dark else "black", not row["verdict"])


def middle(
    ax: Axes, corner: tuple[float, float], text: str, colour: str, hatched: bool = False
) -> None:
    """Text in the middle of a cell, on white where that is hatched."""
    box = {"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 1}
    ax.text(
        corner[0] + 0.5, corner[1] + 0.5, text, ha="center", va="center", fontsize=SMALL,
        color=colour, bbox=box if hatched else None,
    )  # fmt: skip


def per_cents(ax: Axes, values: Sequence[float]) -> None:
    """A logarithmic axis with plain numbers around values."""
    ax.set_yscale("log")
    ax.set_ylim(min(values) / 1.5, max(values) * 1.5)
    wide = max(values) > 30 * min(values)
    ax.yaxis.set_major_locator(LogLocator(subs=(1.0,) if wide else (1.0, 2.0, 5.0)))
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.yaxis.set_minor_formatter(NullFormatter())


def looks_of(names: Sequence[str]) -> dict[str, Look]:
    """The look of each name: a method's is the same in all pictures, others take what is left."""
    usual = {name: LOOK_OF[name] for name in names if name in LOOK_OF}
    colours = {look.colour for look in usual.values()}
    free = [look for look in FURTHER if look.colour not in colours] + FURTHER
    return usual | dict(zip([name for name in names if name not in usual], free))


def labelled_lines(ax: Axes, lines: Mapping[str, tuple[Any, Any]], *, log_y: bool = True) -> None:
    """Lines, at most eight, each with its name at its right end, so that none covers another."""
    looks = looks_of(list(lines))
    ends = list[tuple[float, str, str, float]]()
    for name, (x, y) in lines.items():
        look = looks[name]
        marks = max(1, len(x) // 12)  # among many points
        ax.plot(x, y, color=look.colour, linestyle=look.dash, marker=look.mark, markersize=4,
                markevery=marks, linewidth=look.width)  # fmt: skip
        ends.append((float(y[-1]), name, look.colour, float(x[-1])))
    low, high = ax.get_ylim()
    transform = np.log10 if log_y else np.asarray
    gap = 0.055 * (transform(high) - transform(low))
    last = dict[float, float]()
    for y, name, colour, x in sorted(ends):
        place = float(transform(max(y, low)))
        place = max(place, last[x] + gap) if x in last else place
        last[x] = place
        ax.annotate(
            name, (x, 10**place if log_y else place), xytext=(7, 0), textcoords="offset points",
            color=colour, fontsize=8, va="center", annotation_clip=False,
            bbox={"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 0.5},
        )  # fmt: skip
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)


def coefficients_figure(rows: Mapping[str, Any]) -> Figure:
    """Gaps over the number of coefficients, 10,000 candidates."""
    return _lines_figure(rows["by_terms"], "coefficients", "10,000 candidates")


def budget_figure(rows: Mapping[str, Any]) -> Figure:
    """Gaps over the budget, six coefficients."""
    return _lines_figure(rows["by_budget"], "candidates", "six coefficients")


def _lines_figure(lines: Mapping[str, Any], axis: str, fixed: str) -> Figure:
    figure = new_figure(9.5, 4.2)
    between = lines["between"]
    first, last = (spelled_budget(between["moead-de"]["x"][end]) for end in (0, -1))
    misses = {
        name: " and ".join(dict.fromkeys(two_digits(between[name]["y"][end]) for end in (0, -1)))
        for name in ("moead-de", "epsilon points=50")
    }
    head(
        figure,
        f"With {first} and {last} {axis} MOEA/D-DE has a gap of {misses['moead-de']} %, "
        f"the gradient {misses['epsilon points=50']} %, with motions between",
        f"Gaps to the best known hypervolume; medians over moves, {fixed}",
    )
    for ax, measure, title in zip(
        figure.subplots(1, 2), ("points", "between"), ("50 points each", "with motions between"),
        strict=True,
    ):  # fmt: skip
        series = {
            short_label(name): (line["x"], line["y"]) for name, line in lines[measure].items()
        }
        ax.set_xscale("log")
        per_cents(ax, [value for _, y in series.values() for value in y])
        labelled_lines(ax, series)
        ticks = sorted({x for xs, _ in series.values() for x in xs})
        ax.set_xticks(
            ticks, [spelled_budget(tick) if axis == "candidates" else str(tick) for tick in ticks]
        )
        ax.minorticks_off() if axis == "coefficients" else None
        ax.set_xlabel(axis)
        ax.set_ylabel("hypervolume gap [%]")
        ax.set_title(title, **TITLE)
    return figure


def attained_figure(attained: Mapping[str, Any]) -> Figure:
    """Share of targets attained over processor time."""
    figure = new_figure(7.5, 4.5)
    ax = figure.subplots()
    ax.set_xscale("log")
    ax.set_ylim(0, 1.02)
    after = 1.0  # second
    reached = {
        name: 100 * float(np.interp(after, attained["seconds"], attained["shares"][name]))
        for name in ("epsilon points=50", "moead-de")
    }
    head(
        figure,
        f"After a second the gradient has attained {two_digits(reached['epsilon points=50'])} % "
        f"of the targets, MOEA/D-DE {two_digits(reached['moead-de'])} %",
        "Targets: 50, 20, 10, 5, 2 and 1 % missing on every move; six coefficients, 10,000 "
        "candidates",
    )
    shares = {
        name: values for name, values in attained["shares"].items() if name in attained["drawn"]
    }
    series = {short_label(name): (attained["seconds"], values) for name, values in shares.items()}
    labelled_lines(ax, series, log_y=False)
    ax.set(xlabel="processor time [s]", ylabel="share of targets attained")
    return figure


def profiles_figure(profiles: Mapping[str, Any]) -> Figure:
    """Share of targets attained over candidates per coefficient, without and with limits."""
    figure = new_figure(9.5, 4.4)
    candidates = profiles["per_coefficient"]
    shares = profiles["shares"]
    ends = {
        name: {title: 100 * rows[name][-1] for title, rows in shares.items()}
        for name in ("slsqp", "moead-de")
    }
    head(
        figure,
        f"With 10,000 candidates MOEA/D-DE attains {two_digits(ends['moead-de']['no limits'])} % "
        f"of the targets, SLSQP {two_digits(ends['slsqp']['no limits'])} %; with limits "
        f"{two_digits(ends['moead-de']['limits'])} and {two_digits(ends['slsqp']['limits'])} %",
        f"{profiles['targets'][2]} targets on every problem, from a gap of "
        f"{profiles['targets'][0]:.0f} to {profiles['targets'][1]:.0f} %; six coefficients",
    )
    for ax, (title, rows) in zip(figure.subplots(1, 2), shares.items(), strict=True):
        ax.set_xscale("log")
        ax.set_ylim(0, 1.0)
        series = {short_label(name): (candidates, rows[name]) for name in PROFILED if name in rows}
        labelled_lines(ax, series, log_y=False)
        ax.set_xlim(10, None)
        ax.set(xlabel="candidates per coefficient", ylabel="share of targets attained")
        problems = profiles["problems"][title]
        ax.set_title(f"{title}, {problems} problems", **TITLE)
    return figure


def _over_groups(
    groups: Mapping[str, Sequence[Mapping[str, Any]]],
    labels: Mapping[str, str],
    width: float,
    sentence: str,
) -> Figure:
    """Gaps in each group: lines of the gradient and of seven others at most."""
    figure = new_figure(width, 4.1)
    head(
        figure,
        sentence,
        "Gaps to the best known hypervolume, with motions between; medians over "
        "moves, six coefficients, 10,000 candidates",
    )
    ax = figure.subplots()
    missing = {row["method"]: row["missing"] for rows in groups.values() for row in rows}
    names = sorted((name for name in missing if RANDOM_STARTS not in name), key=missing.get)[:7]
    series: dict[str, tuple[list[int], list[float]]] = {}
    for place, rows in enumerate(groups.values()):
        values = {row["method"]: row["missing"] for row in rows}
        values["epsilon"] = rows[0]["control"]
        for name in ("epsilon", *names):
            if name in values:
                x, y = series.setdefault(short_label(name), ([], []))
                x.append(place)
                y.append(values[name])
    lacks = [value for _, y in series.values() for value in y]
    per_cents(ax, lacks)
    labelled_lines(ax, series)
    slope = 35  # degrees, so that labels stay apart on a phone
    names_of_groups = [labels[name] for name in groups]
    ax.set_xticks(range(len(groups)), names_of_groups, rotation=slope, ha="right")
    ax.set_ylabel("hypervolume gap [%]")
    return figure


def kinds_figure(kinds: Mapping[str, Any]) -> Figure | None:
    """Gaps by the kind of energy."""
    words = {
        "copper": "copper, smooth", "absolute": "|power|", "stages": "in stages",
        "motor-map": "motor's map, jumps", "integer": "an integer",
    }  # fmt: skip
    groups = {kind: kinds[kind] for kind in words if kinds[kind]}
    if "integer" in groups:  # SLSQP keeps the number with which they start
        groups["integer"] = [row for row in groups["integer"] if row["method"] != "slsqp"]
    if not groups:
        return None
    usual, jumping = (
        next(row for row in kinds[kind] if row["method"] == "moead-de")
        for kind in ("absolute", "motor-map")
    )
    sentence = (
        f"With |power| MOEA/D-DE has a gap of {two_digits(usual['missing'])} %, the gradient "
        f"{two_digits(usual['control'])} %; with a map that jumps "
        f"{two_digits(jumping['missing'])} and {two_digits(jumping['control'])} %"
    )
    return _over_groups(groups, words, 8.5, sentence)


def noise_figure(noise: Mapping[str, Any]) -> Figure:
    """Gaps of searches that see objectives with noise, and of the gradient, which has none."""
    rows = {
        share: [{**row, "method": without_noise(row["method"])} for row in compared]
        for share, compared in noise.items()
        if compared
    }
    share, compared = list(rows.items())[-1]
    misses = {row["method"]: two_digits(row["missing"]) for row in compared}
    by_differences = [row for row in compared if row["method"].startswith("slsqp")]
    best = min(by_differences, key=lambda row: row["missing"])
    sentence = (
        f"With noise of {100 * float(share):g} % MOEA/D-DE has a gap of {misses['moead-de']} %, "
        f"SLSQP at best {two_digits(best['missing'])} %"
    )
    labels = {"0": "no noise", "0.01": "noise of 1 %", "0.05": "noise of 5 %"}
    return _over_groups(rows, labels, 7.5, sentence)


def features_figure(prediction: Mapping[str, Any]) -> Figure | None:
    """A feature of every problem beside the outcome."""
    shown = prediction.get("between", {}).get("table")
    if not shown:
        return None
    names = ("coefficients", "condition", "best_basin", "within_1mm")
    labels = (
        "coefficients",
        "condition of the curvature",
        "share of the best basin",
        "share within 1 mm",
    )
    figure = new_figure(11.0, 3.9)
    ranks = prediction["between"]["correlations"]
    head(
        figure,
        f"How far a search is behind the gradient rises with the coefficients (rank correlation "
        f"{two_digits(ranks['coefficients'])}), hardly with the basins "
        f"({two_digits(ranks['best_basin'])})",
        "A point is a problem; 10,000 candidates, with motions between",
    )
    for ax, name, label in zip(figure.subplots(1, 4, sharey=True), names, labels, strict=True):
        for number, plant in enumerate(sorted({row["plant"] for row in shown})):
            look = grammar.look(number)
            rows = [row for row in shown if row["plant"] == plant]
            ax.plot([row[name] for row in rows], [row["outcome"] for row in rows], look.mark,
                    markersize=4, color=look.colour, label=plant)  # fmt: skip
        ax.axhline(0.0, color=grammar.FAINT, linewidth=0.8)
        ax.set_xlabel(label)
        if name in ("coefficients", "condition"):
            ax.set_xscale("log")
        if name == "coefficients":
            ticks = sorted({row[name] for row in shown})
            ax.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
            ax.minorticks_off()
        if name == "within_1mm":
            ax.set_xscale("symlog", linthresh=1e-4)
        ax.grid(alpha=0.25)
    figure.axes[0].set_ylabel("log10 of the gap of the best search\nover that of the gradient")
    figure.axes[0].legend(fontsize=7)
    return figure
