"""benchmarks/crossover.py: its draw, its plan, what it packs, and the figures of its page."""

import itertools
import json
import re
import shutil
import sys
from pathlib import Path

import moocore
import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex
from matplotlib.lines import Line2D

ROOT = Path(__file__).parents[2]
RESULTS = ROOT / "docs" / "results"
sys.path.insert(0, str(ROOT / "benchmarks"))

import crossover  # noqa: E402
from parts.crossover import (  # noqa: E402
    deciding,
    first_table,
    moves,
    packed,
    page,
    pictures,
    plan,
    run,
)
from parts.crossover.batches import time_of  # noqa: E402
from parts.crossover.chosen_shaper import ChosenShaper  # noqa: E402
from parts.crossover.plan import Planned  # noqa: E402
from parts.crossover.problems import Case, read_moves  # noqa: E402
from parts.crossover.shared_terms import SharedTerms  # noqa: E402
from parts.crossover.subset import best_subset  # noqa: E402

import quietarm as qa  # noqa: E402
from quietarm.views.pictures import grammar  # noqa: E402

recompute = page.recompute_module(RESULTS)
from recomputing.areas import area, best_known  # noqa: E402
from recomputing.first_table import OF_LIMITS, add_holm_of_table, judged_rows  # noqa: E402
from recomputing.further_axes import further_figures  # noqa: E402
from recomputing.gaps import Results  # noqa: E402
from recomputing.published import differences, other_lines, wrong_lines  # noqa: E402
from recomputing.runs import Problem, Run, read_runs  # noqa: E402
from recomputing.significance import holm, least_p, signed_ranks  # noqa: E402
from recomputing.tuning import both_tuned, row_of_cell, tuned, tuned_label  # noqa: E402

DRAWN = read_moves(RESULTS / "moves.csv")


def test_the_published_moves_are_those_of_the_seed():
    """The first of every plant that was not drawn again, without solving anything."""
    random = np.random.default_rng(moves.SEED)
    random.choice(5, 2, replace=False)
    first = next(moves.candidates(moves.plants()[0], random))
    assert (DRAWN[0].target, DRAWN[0].duration) == pytest.approx(first)


def test_the_moves_are_thirty_of_five_plants_twelve_of_them_to_tune():
    table = pd.read_csv(RESULTS / "moves.csv")
    assert table["plant"].value_counts().tolist() == [6] * 5
    assert table["use"].value_counts().to_dict() == {"test": 18, "tune": 12}
    for move in DRAWN:
        share = move.duration / moves.first_period(move.plant)
        assert 0.9 <= share <= 2.0


@pytest.mark.slow
def test_all_moves_are_drawn_again():
    for move, published in zip(moves.draw(), DRAWN, strict=True):
        assert (move.name, move.tuning, move.redrawn) == (
            published.name,
            published.tuning,
            published.redrawn,
        )
        assert (move.target, move.duration) == pytest.approx((published.target, published.duration))


@pytest.fixture(scope="module")
def planned():
    return list(plan.rounds(DRAWN, {}))


def test_the_plan_has_every_run_once_and_ends_a_round_before_the_next(planned):
    keys = [entry.key for entry in planned]
    assert len(set(keys)) == len(keys)
    rounds = [entry.round for entry in planned]
    assert rounds == sorted(rounds)


def test_the_plan_tests_on_no_move_of_tuning(planned):
    assert not any(entry.case.move.tuning for entry in planned)
    assert len({entry.case.move.name for entry in planned}) == 18


def test_the_crossing_has_every_cell_on_every_move(planned):
    cells = {
        (entry.case.terms, entry.budget, entry.case.move.name)
        for entry in planned
        if entry.axis in ("centre", "crossing") and entry.budget
    }
    assert len(cells) == 6 * 2 * 18


def test_what_the_first_table_compares_has_fifteen_seeds_in_the_plan(planned):
    """The search that the first seeds have chosen, and its rival."""
    figures = json.loads((RESULTS / "figures.json").read_text())
    own = {"model": "centre", "smooth": "centre", "three": "objectives", "four": "objectives"}
    for row in figures["judged"]:
        if not row["comparisons"]:
            continue
        decides = deciding.DECIDING[own.get(row["row"], row["row"])]
        assert row["search"] in decides.labels
        assert row["rival"] in (*decides.labels, "epsilon")
        seeds = {entry.round for entry in planned if decides.has(entry)}
        assert seeds == set(range(15))


def made_up_runs(axis, method, lacks_of_seeds, kind="absolute"):
    """On ten moves, the runs of a method: its first point lacks so much, and more on later moves.

    No two moves differ by as much: p of ties takes a second.
    """
    settings, budget = ("points=50", 0) if method == "epsilon" else ("", 10_000)
    return [
        Run(
            axis, f"single-link-m{move}-6-{kind}", method, settings, budget, seed,
            1.0, 1.0, points := np.array([[lacks * (1 + move / 100), 0.0], [0.0, 1.0]]), points,
            np.empty((0, 3)),
        )
        for move in range(10)
        for seed, lacks in enumerate(lacks_of_seeds)
    ]  # fmt: skip


def test_a_new_axis_is_in_the_appendix_by_its_runs_alone():
    """Neither recompute.py nor a template knows it: its name is what its problems' names say."""
    lacks = {"epsilon": [0.0], "gde3": [0.2], "slsqp": [0.3]}
    runs = [
        run
        for method, values in lacks.items()
        for run in made_up_runs("sticking", method, values, "absolute-sticking")
    ]
    further = further_figures(Results(runs))
    ((name, cells),) = [(name, cells) for name, cells in further.items() if cells]
    assert name == "absolute-sticking, 6 coefficients"
    figures = json.loads((RESULTS / "figures.json").read_text())
    text = page.page_of("further.md", figures | {"further": further}, RESULTS)
    (cell,) = cells
    assert [row["method"] for row in cell["differences"]] == ["gde3"]
    assert "### Absolute-sticking, 6 coefficients" in text
    # all ten moves of one sign, and one comparison
    assert re.search(r"\| 10,000 \| 10 \| 1 \| GDE3 \|.*\| 10 of 10 \| 0.002 \|$", text, re.M)


def test_first_seeds_choose_and_fresh_ones_judge():
    """Luck of the first seeds chooses a search, and does not count for it."""
    runs = [
        *made_up_runs("centre", "epsilon", [0.0] * 5),
        *made_up_runs("centre", "gde3", [0.1] * 3 + [0.4] * 2),
        *made_up_runs("centre", "nsga2", [0.2] * 5),
        *made_up_runs("centre", "slsqp", [0.3] * 5),
    ]
    (row,) = [row for row in judged_rows(Results(runs)) if row["row"] == "smooth"]
    assert (row["search"], row["rival"]) == ("gde3", "slsqp")
    (judged,) = row["comparisons"]
    assert (judged["moves"], judged["seeds"]) == (10, 2)
    assert judged["by"]["between"]["better"] == judged["equal"] == 0
    # two comparisons in all, against SLSQP and the gradient, each with ten moves of one sign
    assert judged["by"]["between"]["holm"] == pytest.approx(2 * least_p(10))
    line = first_table.line_of(row, "-")
    assert (line["take"], line["better"]) == ("`slsqp`", "10/10")


def test_holm_is_over_all_rows_of_the_first_table():
    """The arms in MuJoCo and several basins count among its comparisons."""
    runs = [
        *made_up_runs("centre", "epsilon", [0.0] * 5),
        *made_up_runs("centre", "nsga2", [0.2] * 5),
        *made_up_runs("centre", "slsqp", [0.3] * 5),
    ]
    rows = judged_rows(Results(runs))
    arms = {"judged": {"p": least_p(10)}}
    of_methods = {"p": 0.1, "holm": 0.6}
    add_holm_of_table(rows, arms, {"posts": {"cells": [{"search_against_slsqp": of_methods}]}})
    tests = [one["by"]["between"] for row in rows for one in row["comparisons"]]
    # three of one sign on ten moves, and one that Holm has adjusted over methods before
    holm_of_ten = pytest.approx(4 * least_p(10))
    assert [test["holm"] for test in (*tests, arms["judged"])] == [holm_of_ten] * 3
    assert of_methods == {"p": 0.1, "holm": 0.6, "holm_of_table": 0.6}


@pytest.mark.slow  # it compiles a profile for each shaper
def test_a_search_takes_every_shaper_though_one_leaves_nothing_to_choose(tmp_path):
    """Through one of them this carriage's front is a single motion: no scale for others."""
    (move,) = (move for move in DRAWN if move.name == "linear-axis-m3")
    planned = Planned("integers", 0, Case(move, 6, "shaper"), "slsqp", 90, in_turn=True)
    front = run.front_by_every_number(planned, tmp_path)
    assert front.points
    assert front.history[-1].evaluations == 4 * (90 // 4)
    assert set(front.coefficients[:, 0]) <= {1.0, 2.0, 3.0, 4.0}


def test_tuned_settings_are_run_under_the_label_by_which_the_figures_find_them():
    """Evaluations of a candidate are tuned as a setting is, and are an argument of the run."""
    settings = {"scale": 0.5, "reevaluate": 3, "population": 30}
    tuned_settings = {("noise", "moead-de"): tuple(sorted(settings.items()))}
    entry = next(plan.tuned(DRAWN[:1], DRAWN[:1], tuned_settings, 0))
    assert (entry.reevaluate, entry.noise) == (3, 0.01)
    assert dict(entry.settings) == {"population": 30, "scale": 0.5}
    trial = {"score": "0.1", "settings": json.dumps(settings)}
    usual = {"crossover": 1.0, "mutation_eta": 20.0, "population": 100}
    assert not list(plan.tuned([], DRAWN[:1], {("limits", "moead-de"): tuple(usual.items())}, 0))
    label = tuned_label("moead-de", trial, row_of_cell("noise"))
    assert label == f"moead-de {entry.words}"


def test_tuned_methods_are_held_against_each_other_over_moves(tmp_path):
    """Four kinds of limit on a move are one move: p cannot be less than five moves can give."""
    (tmp_path / "tuning.csv").write_text(
        "cell,method,budget,trial,score,settings\n"
        'limits,gde3,5000,0,1,"{""population"": 100}"\n'
        'limits,gde3,5000,1,0,"{""population"": 30}"\n'
        'limits,slsqp,5000,0,1,"{""step"": 1e-05}"\n'
        + "".join(
            f'limits,moead-de,5000,{trial},{trial},"{{""population"": {100 - trial}}}"\n'
            for trial in range(8)
        )
    )
    gaps = {
        ("epsilon", "points=50"): 0.0,
        ("gde3", ""): 0.4,
        ("gde3", "population=30"): 0.1,
        ("slsqp", ""): 0.3,
        ("slsqp", "step=1e-05"): 0.2,
        ("moead-de", ""): 0.45,
    }
    runs = [
        Run(
            "tuned" if "=" in settings else "limits", f"single-link-m{move}-6-{kind}", method,
            settings, 0 if method == "epsilon" else 10_000, 0, 1.0, 1.0,
            points := np.array([[lacks, 0.0], [0.0, 1.0]]), points, np.empty((0, 3)),
        )
        for (method, settings), lacks in gaps.items()
        for move in range(5)
        for kind in OF_LIMITS
    ]  # fmt: skip
    results = Results(runs)
    row, of_usual = both_tuned(results, tmp_path)
    assert (row["cell"], row["method"], row["problems"]) == ("limits", "gde3", 20)
    assert (row["default"]["better"], row["tuned"]["better"]) == (0, 20)
    assert row["tuned"]["holm"] == pytest.approx(2 * least_p(5))
    # no trial is better than the first one, which has the usual settings and their runs
    assert (of_usual["method"], of_usual["tuned"]["first"]) == (
        "moead-de", of_usual["default"]["first"],
    )  # fmt: skip
    of_methods = {row["method"]: row["between"] for row in tuned(results, tmp_path)}
    assert {name: row["nearer"] for name, row in of_methods.items()} == {
        "gde3": 20, "slsqp": 20, "moead-de": 0,
    }  # fmt: skip
    assert of_methods["gde3"]["holm"] == pytest.approx(2 * least_p(5))


@pytest.mark.parametrize(
    ("differences", "words"),
    [
        ((-1.0, -2.0, -1.0, 0.0), "`es`"),
        ((-1.0, -2.0, 0.0, 0.0), "tentative: `es`"),
        ((-1.0, 0.0, 0.0, 0.0), "tentative: `es`"),
        ((-1.0, -1.0, 1.0, 0.0), "tentative: `es`"),
        ((1.0, 1.0, 1.0, 0.0), "`slsqp`"),
        ((0.0, 0.0, 0.0, -0.1), "not significant: `slsqp`"),
    ],
)
def test_a_row_of_several_kinds_is_sure_if_half_of_them_are(differences, words):
    """A difference of at least one is significant here."""
    tests = [{"difference": d, "holm": 0.01 if abs(d) >= 1 else 0.5} for d in differences]
    row = {
        "row": "limits",
        "search": "es",
        "rival": "slsqp",
        "measure": "between",
        "comparisons": [{"by": {"between": test}} for test in tests],
    }
    assert first_table.take_words(row, *first_table.verdict_of(row)) == words


@pytest.mark.slow
def test_a_new_machine_goes_on_from_the_tables_alone(tmp_path, planned):
    shutil.copy(RESULTS / "moves.csv", tmp_path)
    done = planned[:3]
    rows = [
        {**dict.fromkeys(packed.COLUMNS, ""), **dict(zip(packed.KEY, map(str, entry.key)))}
        for entry in done
    ]
    packed.write_rows(rows, run.runs_path(tmp_path, done[0].axis))
    assert run.missing_of(tmp_path) == planned[3:]


@pytest.mark.slow
def test_parts_share_the_plan(tmp_path, planned):
    shutil.copy(RESULTS / "moves.csv", tmp_path)
    parts = [run.missing_of(tmp_path, (number, 3)) for number in (1, 2, 3)]
    assert sorted(entry.key for part in parts for entry in part) == sorted(
        entry.key for entry in planned
    )


@pytest.mark.parametrize(
    ("typed", "words"),
    [
        (["--part", "5/4"], "part is '5/4'; give a number of how many, such as 2/4"),
        (["--axis", "budgets"], "no axis is called 'budgets'; give one of centre,"),
        (["--deciding", "rows"], "no row is called 'rows'; give one of centre,"),
        (["--tune", "es", "--cell", "rows"], "no cell is called 'rows'; give one of centre,"),
    ],
)
def test_what_cannot_be_is_refused_in_a_line(tmp_path, capsys, typed, words):
    with pytest.raises(SystemExit) as stopped:
        crossover.main([str(tmp_path / "runs"), *typed])
    assert stopped.value.code == 2
    assert words in capsys.readouterr().err
    assert not (tmp_path / "runs").exists()


def test_tables_come_back_as_they_were_with_the_same_bytes(tmp_path):
    row = {name: f"{number} 0.5" for number, name in enumerate(packed.COLUMNS)} | {"seed": "3"}
    other = row | {"seed": "1"}
    path = tmp_path / "runs" / "centre.csv.xz"
    packed.write_rows([row, other], path)
    before = path.read_bytes()
    assert packed.read_rows(path) == [other, row]
    packed.write_rows(packed.read_rows(path), path)
    assert path.read_bytes() == before


def test_the_subset_of_two_objectives_is_the_best_of_all():
    points = np.random.default_rng(5).uniform(0.0, 1.2, (40, 2))
    inside = points[(points < 1.1).all(axis=1)]
    front = moocore.filter_dominated(inside)
    assert len(front) > 4

    def area(rows):
        return moocore.hypervolume(rows, ref=[1.1, 1.1])

    chosen = points[best_subset(points, 3)]
    assert len(chosen) == 3
    # every choice of three
    best = max(area(np.array(rows)) for rows in itertools.combinations(front, 3))
    assert area(chosen) == pytest.approx(best)


def test_the_subset_of_three_objectives_has_so_many_that_none_dominates():
    points = np.random.default_rng(6).uniform(0.0, 1.0, (60, 3))
    chosen = points[best_subset(points, 5)]
    assert len(chosen) == 5
    assert moocore.is_nondominated(chosen).all()


def test_the_best_known_area_is_above_straight_lines():
    # a line from (0, 1) to (1, 0): half the unit square, and a margin of 0.1 on two sides
    points = np.column_stack([np.linspace(0, 1, 11), np.linspace(1, 0, 11)])
    assert best_known(points) == pytest.approx(0.5 + 0.1 + 0.1 * 1.1)


def test_p_values_are_those_of_holm_and_of_all_signs_alike():
    assert holm([0.01, np.nan, 0.04, 0.03]) == pytest.approx(
        [0.03, np.nan, 0.06, 0.06], nan_ok=True
    )
    # all ten differences of one sign: 2 of 2^10 arrangements
    assert signed_ranks(np.arange(1.0, 11.0)) == pytest.approx(least_p(10))


def test_a_name_says_plant_move_coefficients_and_energy():
    problem = Problem("arm-on-flexible-link-m3-16-motor-map")
    assert (problem.plant, problem.move) == ("arm-on-flexible-link", "arm-on-flexible-link-m3")
    assert (problem.terms, problem.kind) == (16, "motor-map")


@pytest.mark.parametrize("number", [1, 2, 5])
def test_an_integer_is_the_number_of_terms_that_share_a_box(number):
    coefficients = np.array([0.02, -0.05, 0.1, 0.04, -0.03])
    shared = SharedTerms(5)
    lower, upper = shared.box(0.2)
    assert lower[0] < 0.6 < upper[0]
    alone = qa.CycloidPolynomial(number)
    for fraction in (0.1, 0.4, 0.9):
        motion = alone.angle(list(3 * coefficients[:number] / number), fraction)
        for rounded in (number - 0.4, number, number + 0.4):
            share = shared.angle([rounded, *coefficients], fraction)
            assert float(share) == pytest.approx(float(motion), abs=1e-12)


@pytest.mark.parametrize(("number", "shaper"), [(1, None), (3, "zvd")])
def test_an_integer_is_the_shaper_that_a_motion_passes(number, shaper):
    choice = ChosenShaper(("none", "zv", "zvd"), periods=1.6, damping_ratio=0.02, terms=3)
    coefficients = [0.05, -0.1, 0.02]
    duration = 0.8
    frequency = 2 * np.pi * 1.6 / duration
    plain = qa.CycloidPolynomial(0)
    if shaper is not None:
        shaped = qa.ocp.ShapedCycloid(shaper, (frequency,), (0.02,)).at_duration(duration)
    for fraction in (0.4, 0.9):
        chosen = float(choice.angle([number + 0.3, *coefficients], fraction))
        alone = float(choice.alone(number).angle(coefficients, fraction))
        assert chosen == pytest.approx(alone, abs=1e-12)
        at_zero = float(choice.angle([number, 0, 0, 0], fraction))
        expected = plain.angle([], fraction) if shaper is None else shaped.angle([], fraction)
        assert at_zero == pytest.approx(float(expected), abs=1e-12)


def test_time_on_many_cores_is_the_rounds_of_every_call():
    calls = [1, 6, 100, 250]
    assert time_of(calls, 1) == 357
    assert time_of(calls, 100) == 1 + 1 + 1 + 3


def test_choose_repeats_what_the_page_says():
    text = (ROOT / "docs" / "choose.md").read_text()
    assert page.decision_in(text) == page.decision_in((RESULTS / "report.md").read_text())
    assert page.decision_in(text).count("\n") >= 9  # the table of the page


def test_the_page_is_that_of_its_figures():
    figures = json.loads((RESULTS / "figures.json").read_text())
    size = sum(path.stat().st_size for path in RESULTS.rglob("*") if path.is_file())
    assert size < 15e6
    for name in ("report.md", "appendix.md"):
        assert f"{sum(figures['runs'].values()):,} runs" in (RESULTS / name).read_text()
    assert len((RESULTS / "report.md").read_text().split()) <= 1000  # with the words of tables


@pytest.mark.slow
def test_pictures_say_what_is_seen_in_colours_of_the_grammar():
    figures = json.loads((RESULTS / "figures.json").read_text())
    drawn = [
        pictures.map_figure(figures["map"], page.WAYS, "gradient"),
        pictures.coefficients_figure(figures["map_rows"]),
        pictures.budget_figure(figures["map_rows"]),
        pictures.attained_figure(figures["attained"]),
        pictures.profiles_figure(figures["profiles"]),
        pictures.kinds_figure(figures["kinds"]),
        pictures.noise_figure(figures["noise"]),
        pictures.features_figure(figures["prediction"]),
    ]
    for figure in drawn:
        sentence, facts = figure.get_suptitle().split("\n", 1)
        assert len(sentence.split()) > 8
        assert facts
        lines = {to_hex(line.get_color()).upper() for line in figure.findobj(Line2D) if line.axes}
        of_axes = {"#000000", "#B0B0B0"}
        assert lines - of_axes <= grammar.INKS
    # as the tables of the page say
    assert "21 and 1" in drawn[0].get_suptitle()
    assert "MOEA/D-DE has a gap of 0.66 and 26 %" in drawn[1].get_suptitle()


def test_the_pages_are_those_of_the_templates_and_a_wrong_digit_is_named():
    figures = json.loads((RESULTS / "figures.json").read_text())
    assert wrong_lines(RESULTS, figures) == []
    text = (RESULTS / "report.md").read_text()
    line = other_lines("report.md", with_another_digit(text, "| a model that"), text)
    assert re.fullmatch(r"report.md, line \d+: \S+ is printed, and the files give \S+", *line)


def with_another_digit(text, row):
    """A text whose first digit after some words is another one."""
    digit = re.compile(r"\d").search(text, text.index(row))
    other = str((int(digit[0]) + 1) % 10)
    return text[: digit.start()] + other + text[digit.end() :]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["report.md", "appendix.md", "choose.md"])
def test_the_published_script_ends_with_1_for_a_wrong_digit_on_any_page(name, tmp_path, capsys):
    folder = tmp_path / "results"
    shutil.copytree(RESULTS, folder, ignore=shutil.ignore_patterns("*.png"))
    shutil.copy(ROOT / "docs" / "choose.md", tmp_path)
    path = folder.parent / name if name == "choose.md" else folder / name
    row = "| MOEA/D-DE |" if name == "appendix.md" else "| a model that"
    path.write_text(with_another_digit(path.read_text(), row))
    assert recompute.main([str(folder)]) == 1
    (line,) = [line for line in capsys.readouterr().out.splitlines() if "printed" in line]
    assert re.match(rf".*{name}, line \d+: ", line)


def test_runtime_profiles_rise_and_end_as_the_table_says():
    profiles = json.loads((RESULTS / "figures.json").read_text())["profiles"]
    page_text = (RESULTS / "appendix.md").read_text()
    for title, rows in profiles["shares"].items():
        for shares in rows.values():
            assert (np.diff(shares) >= 0).all()
            assert 0 <= shares[0] <= shares[-1] <= 1
        (line,) = re.findall(rf"\| {title}, share attained .*", page_text)
        of_table = [float(cell) for cell in line.split("|")[2:-1]]
        ends = [100 * rows[name][-1] for name in profiles["shares"]["limits"]]
        assert of_table == pytest.approx(ends, abs=0.5)


@pytest.mark.slow
def test_the_figures_are_those_of_the_files():
    figures = json.loads(json.dumps(recompute.compute(RESULTS)))
    published = json.loads((RESULTS / "figures.json").read_text())
    assert differences(published, figures) == []


@pytest.mark.slow
def test_a_small_crossing_from_end_to_end(tmp_path, capsys):
    """Two methods on one move; the second call runs nothing, with the files of the runs gone."""
    move = next(move for move in DRAWN if not move.tuning)
    jobs = [
        Planned("centre", 0, Case(move, 2), "gde3", 300),
        Planned("centre", 0, Case(move, 2), "epsilon", None, (("points", 10),)),
    ]
    results = tmp_path / "results"
    assert run.run_jobs_of(jobs, tmp_path / "runs", results) == 0
    shutil.rmtree(tmp_path / "runs")
    assert run.done_keys(results) == {job.key for job in jobs}
    by_search, by_gradient = sorted(read_runs(results), key=lambda run: -run.budget)
    assert by_search.marks[-1, 0] == 300
    assert area(by_gradient.between) > area(by_search.points) > 0
    # with motions between, ten points are a curve
    assert area(by_gradient.between) > area(by_gradient.points)
