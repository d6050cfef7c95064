"""The grammar of pictures: every public figure is drawn in it, and docs/pictures.md states it."""

import itertools
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from inks import inks_of, scales_of
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from matplotlib.text import Text
from pages import DOCS, ROOT

import quietarm as qa
from quietarm.models import LinearAxis
from quietarm.ocp import (
    CycloidPolynomial,
    Mark,
    Polish,
    energy_floor,
    evaluate_robustness,
    time_front,
)
from quietarm.ocp.front.polish import Gain
from quietarm.studies.compare import compare_fronts, compare_plans
from quietarm.views.film import _draw, animate
from quietarm.views.pictures import Line
from quietarm.views.pictures.axes import NARROW
from quietarm.views.pictures.grammar import HEAT, INKS, MEANINGS, OTHERS, look, looks, variants

GRAMMAR = {ink.lower() for ink in INKS}


@pytest.fixture(scope="module")
def robust(task):
    uncertain = replace(task, uncertainty=qa.Uncertainty({"frequency": 0.05}), torque_limit=0.4)
    return qa.plan_move(uncertain, CycloidPolynomial(2))


@pytest.fixture(scope="module")
def seeds(front_of):
    history = (Mark(10, 0.2), Mark(20, 0.6))
    return [
        front_of([(0.1, 0.7 + seed), (2, 0.4)], "nsga2", seed=seed, history=history)
        for seed in range(3)
    ]


@pytest.fixture(scope="module")
def gradient(front_of):
    return front_of([(0, 0.6), (1, 0.4), (9, 0.2)], "epsilon", seed=None, gaps=((2e-3, 6e-3),))


@pytest.fixture(scope="module")
def surface(task):
    """Motions with three objectives."""
    random = np.random.default_rng(0)
    return qa.Front.from_coefficients(
        task,
        random.uniform(-0.1, 0.1, (12, 2)),
        method="random",
        profile=CycloidPolynomial(2),
        bound=0.2,
        objectives=("residual", "energy", "peak_torque"),
    )


@pytest.fixture(scope="module")
def machine():
    """A swing of 3.2 Hz, twice, and the beam that it is of."""
    time = np.arange(0, 3, 0.005)
    swing = 20 * np.exp(-0.2 * time) * np.cos(2 * np.pi * 3.2 * time)
    noise = np.random.default_rng(0).normal(0, 0.3, (2, len(time)))
    recordings = [qa.Recording(time, tip=swing + noise[i], name=f"{i}") for i in range(2)]
    return qa.identify(recordings, qa.FlexibleBeam()), recordings


@pytest.fixture(scope="module")
def figures(task, plan, robust, seeds, gradient, surface, machine):
    """Every public figure by its name, and a frame of a film."""
    named = {"plan": plan, "robust plan": robust}
    lines = [Line(motion, name) for name, motion in named.items()]
    judged = compare_plans(named, ["cycloid", "zv"], {"frequency": 0.1}, samples=20)
    by_band = compare_plans(named, ["zv"], task=replace(task, band=1e-3))
    axis = LinearAxis(omega1=28.2, zeta1=0.007, mass=60.0, load=12.0)
    limits = {"speed_limit": 1.5, "acceleration_limit": 7.0, "jerk_limit": 150.0}
    by_time = time_front(axis.task(0.4, 1.0, band=1e-3, **limits), points=2)
    comparison = replace(compare_fronts([gradient, *seeds], fill=False), floor=0.1)
    square = {"lower": [-1.0, -1.0], "upper": 1.0, "evaluations": 30, "algorithm": "es"}
    of_function = compare_fronts(
        [qa.search(lambda x: x**2, **square, seed=seed) for seed in (0, 1)], fill=False
    )
    errors = evaluate_robustness(plan.candidate, {"frequency": 0.1}, samples=1)
    floor = energy_floor(task, starts=1, energy_tolerance=0.5)
    polish = Polish(gradient, (Gain(1e-3, 0.5, 0.4), Gain(9e-3, 0.3, 0.2)))
    of = qa.pictures
    return {
        "motion_figure": of.motion_figure(lines),
        "draw_quantity": of.draw_quantity(robust, "torque").figure,
        "floor_figure": of.floor_figure(floor, plan),
        "front_figure": of.front_figure(seeds),
        "polish_figure": of.polish_figure(seeds[0], polish),
        "draw_fronts": of.draw_fronts([gradient, *seeds]).figure,
        "draw_hypervolume": of.draw_hypervolume(seeds).figure,
        "draw_peak": of.draw_peak([surface]).figure,
        "draw_parallel": of.draw_parallel([surface, surface]).figure,
        "draw_seed_energies": of.draw_seed_energies(seeds).figure,
        "function_comparison_figure": of.function_comparison_figure(of_function),
        "comparison_figure": of.comparison_figure(comparison),
        "draw_comparison": of.draw_comparison(comparison, small=True).figure,
        "draw_gaps": of.draw_gaps(comparison).figure,
        "time_front_figure": of.time_front_figure(by_time),
        "acting_figure": of.acting_figure(by_band, "a move"),
        "draw_acting": of.draw_acting(by_band).figure,
        "motions_figure": of.motions_figure(judged, "a move"),
        "draw_motions": of.draw_motions(judged).figure,
        "draw_robustness": of.draw_robustness({"plan": errors}, "frequency").figure,
        "identification_figure": of.identification_figure(*machine),
        "a film": _draw(animate(plan, width=240))[0],
    }


@pytest.mark.slow
def test_every_public_figure_is_drawn_in_the_colours_of_the_grammar(figures):
    public = {name for name in qa.pictures.__all__ if re.match("draw_|.*_figure$", name)}
    assert set(figures) - {"a film"} == public
    strange = {name: inks_of(figure) - GRAMMAR for name, figure in figures.items()}
    assert {name: inks for name, inks in strange.items() if inks} == {}
    assert set().union(*map(scales_of, figures.values())) <= {HEAT}


def letters_of(figure):
    """Sizes of the words of a figure [points]."""
    texts = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text()]
    return {text.get_fontsize() for text in texts}


@pytest.mark.slow
def test_letters_are_as_high_as_the_site_counts_on(figures):
    # docs/_extensions/readable_pictures.py: at 93 pixels an inch 7 points are 9 pixels
    for name, figure in figures.items():
        assert min(letters_of(figure)) >= (10 if name == "a film" else 7), name
    for notebook in (ROOT / "notebooks").glob("*.ipynb"):
        sizes = re.findall(r"fontsize=([\d.]+)", notebook.read_text(encoding="utf-8"))
        assert all(float(size) >= 7 for size in sizes), notebook.name


@pytest.mark.slow
def test_every_figure_fits_a_phone_when_it_is_stacked(figures):
    for name, figure in figures.items():
        stacked = None if name == "a film" else qa.pictures.stack(figure)
        if stacked is not None:
            stacked.draw_without_rendering()
            drawn = stacked.get_tightbbox()  # [inch]
            assert drawn.width <= NARROW + 0.05, name
            assert drawn.x0 >= -0.02, name
            assert drawn.x1 <= NARROW + 0.02, name


@pytest.mark.slow
def test_titles_stand_left_and_axes_have_units(figures):
    for name, figure in figures.items():
        if figure.get_suptitle():
            assert figure._suptitle.get_horizontalalignment() == "left", name
        for ax in figure.axes:
            assert ax.get_title() == "", name  # that in the middle
            if ax.axison and ax.lines:
                # a panel over time has its quantity with its unit at the head of the axis
                # parallel coordinates have a unit at each of their ticks
                ticks = "".join(label.get_text() for label in ax.get_xticklabels())
                below = ax.get_xlabel() or (ticks if "[" in ticks else "[s]")
                heads = [ax.get_ylabel() + ax.get_title(loc="left"), below]
                counted = ("ring-down", "candidates evaluated", "seed (x:", "share of the area")
                for words in heads:
                    assert "[" in words or any(word in words for word in counted), (name, words)


def colours_by_label(figure):
    """The colour of each line in the legends of a figure."""
    return {
        line.get_label(): line.get_color()
        for ax in figure.axes
        for line in ax.get_lines()
        if not line.get_label().startswith("_")
    }


@pytest.mark.slow
def test_what_a_line_is_decides_its_look(figures, plan, cycloid):
    blue, grey, green, orange = (
        MEANINGS[meaning].colour for meaning in ("plan", "plain cycloid", "robust plan", "search")
    )
    moved = colours_by_label(figures["motion_figure"])
    assert (moved["plan"], moved["robust plan"]) == (blue, green)
    assert moved["limit"] == MEANINGS["limit"].colour
    assert colours_by_label(qa.motion_figure(plan)) == {"plain cycloid": grey, "this plan": blue}
    (panel,) = figures["draw_fronts"].axes
    fronts = {line.get_label(): line for line in panel.get_lines()}
    assert fronts["gradient (epsilon constraint)"].get_color() == blue
    assert fronts["search (NSGA-II), seed 0"].get_color() == orange
    assert set(colours_by_label(figures["draw_seed_energies"])) <= {orange}
    compared = colours_by_label(figures["motions_figure"])
    assert (compared["plan"], compared["robust plan"], compared["cycloid"]) == (blue, green, grey)
    assert compared["zv"] == MEANINGS["ZV"].colour
    # a line that brings its own colour has it, and another of the same meaning is told apart
    own = [Line(plan, "first"), Line(plan, "second"), Line(cycloid, "third", "black")]
    first, second, third = colours_by_label(qa.pictures.draw_quantity(own, "angle").figure).values()
    assert (first, third) == (blue, "black")
    assert second in OTHERS


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("shaper", ["zv", "zvd", "ei"])
def test_a_shaper_has_one_look_in_every_figure(shaper, task, plan):
    name = shaper.upper()
    motion = qa.evaluate_coefficients(task, [], profile=qa.shaped_cycloid(task, shaper))
    judged = compare_plans({"plan": plan}, [shaper], {"frequency": 0.1}, samples=20)
    errors = evaluate_robustness(motion.candidate, {"frequency": 0.1}, samples=1)
    figures = [
        qa.pictures.motions_figure(judged, "a move"),
        qa.pictures.draw_robustness({name: errors}, "frequency").figure,
        qa.motion_figure([Line(plan, "plan"), Line(motion, name)]),
    ]
    for figure in figures:
        lines = {line.get_label().upper(): line for ax in figure.axes for line in ax.get_lines()}
        assert lines[name].get_color() == MEANINGS[name].colour
        width = lines[name].get_linewidth()  # by which matplotlib multiplies dashes
        drawn = Line2D([], [], linestyle=MEANINGS[name].dash, linewidth=width)
        assert lines[name].get_linestyle() == drawn.get_linestyle()
        assert lines[name]._dash_pattern == drawn._dash_pattern
    for notebook in (ROOT / "notebooks").glob("*.ipynb"):  # none is given a colour of its own
        own = rf'Line\([^)]*{name}[^)]*(RED|BLUE|GREEN|GREY|ORANGE)|"{name}": (RED|BLUE|GREEN)'
        assert not re.search(own, notebook.read_text(encoding="utf-8")), notebook.name


def test_nothing_but_a_limit_is_dotted():
    dotted = {MEANINGS["limit"].dash, (0, (1, 1))}
    others = [meant for name, meant in MEANINGS.items() if name != "limit"]
    others += [*map(look, range(90)), *looks([""] * 30), *variants("search", 30)]
    assert dotted & {meant.dash for meant in others} == set()
    for notebook in (ROOT / "notebooks").glob("*.ipynb"):
        cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
        for cell in cells:
            for line in cell["source"] if cell["cell_type"] == "code" else []:
                if re.search(r"""['"]:['"]|dotted""", line) and "title" not in line:
                    assert re.search("axhline|limit", line), (notebook.name, line)


def test_after_arrival_a_motion_is_lighter_and_arrival_a_thin_dashed_line(plan):
    ax = qa.pictures.draw_quantity([Line(plan, "plan")], "deflection")
    before, after, arrival = ax.get_lines()
    assert (before.get_alpha() or 1.0) == 1.0
    assert after.get_alpha() < 0.6
    assert before.get_xdata()[-1] == after.get_xdata()[0] == plan.task.duration
    assert (arrival.get_linestyle(), arrival.get_xdata()) == ("--", [plan.task.duration] * 2)
    assert arrival.get_linewidth() < before.get_linewidth()


def test_looks_are_told_apart():
    numbered = [look(number) for number in range(90)]
    assert len(set(numbered)) == 90
    of_meanings = looks(["plan", "search", "plan", "", "search", "search"])
    assert [mine.colour for mine in of_meanings[:2]] == ["#0072B2", "#CF7600"]
    assert {mine.colour for mine in of_meanings[2:]} <= {*OTHERS}
    assert len(set(of_meanings)) == 6
    without = {(mine.colour, mine.dash) for mine in looks([""] * 25)}
    assert len(without) == 25  # in print, too, where no mark is drawn
    of_seeds = variants("search", 9)
    assert {mine.colour for mine in of_seeds} == {"#CF7600"}
    assert len(set(of_seeds)) == 9


# Linear RGB as it is seen: Machado, Oliveira and Fernandes, "A physiologically-based model for
# simulation of color vision deficiency", 2009, severity 1.0
SEEN = {
    "by most": np.eye(3),
    "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
                   [-0.003882, -0.048116, 1.051998]],
    "deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
                     [-0.011820, 0.042940, 0.968881]],
    "tritanopia": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602],
                   [0.004733, 0.691367, 0.303900]],
}  # fmt: skip


def lab(linear):
    """CIE 1976 L*a*b* of linear sRGB, white D65."""
    to_xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    x, y, z = np.cbrt(to_xyz @ np.clip(linear, 0, 1) / [0.9505, 1.0, 1.089])
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def linear(colour):
    """Linear RGB of a colour, by the definition of sRGB."""
    encoded = np.array(to_rgb(colour))
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


@pytest.mark.parametrize("eye", SEEN)
def test_meanings_stay_apart_for_colour_blind_readers(eye):
    meanings = ("plan", "plain cycloid", "robust plan", "search", "ZV", "ZVD", "EI")
    for on_page in ("colour", "on_dark"):
        seen = [lab(SEEN[eye] @ linear(getattr(MEANINGS[name], on_page))) for name in meanings]
        distances = [np.linalg.norm(a - b) for a, b in itertools.combinations(seen, 2)]
        assert min(distances) > 10  # 2.3 can just be told from each other side by side


def test_colours_are_seen_on_white_and_on_a_dark_page():
    def contrast(colour, page):
        """By WCAG 2: 3 is enough for lines."""
        of_both = [np.array([0.2126, 0.7152, 0.0722]) @ linear(c) + 0.05 for c in (colour, page)]
        return max(of_both) / min(of_both)

    for name, meaning in MEANINGS.items():
        assert contrast(meaning.colour, "white") >= 3, name
        assert contrast(meaning.on_dark, "#171c23") >= 3, name


def test_the_page_states_the_grammar():
    stated = dict(re.findall(r"^\| (.+?) \| .*`(#\w{6})`", DOCS["pictures"], re.MULTILINE))
    assert {name: stated[name] for name in MEANINGS} == {
        name: meaning.colour for name, meaning in MEANINGS.items()
    }
