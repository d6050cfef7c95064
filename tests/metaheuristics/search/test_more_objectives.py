"""Searches of three objectives and four: every preset, what enters, directions, hypervolumes."""

import json
from dataclasses import replace
from math import comb

import moocore
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymoo.algorithms.moo.nsga3 import NSGA3
from pymoo.util.ref_dirs import get_reference_directions
from small_searches import SIXTH, exactly

import quietarm as qa
from quietarm.metaheuristics import PRESETS, Job, MoveFunction, problem_of
from quietarm.metaheuristics.archive import Archive, entering
from quietarm.metaheuristics.evaluation.stated_figures import check_figures
from quietarm.metaheuristics.methods.building import directions
from quietarm.metaheuristics.score import CORNER, HYPERVOLUME, Scale, share_of_box
from quietarm.metaheuristics.thinning import thinned
from quietarm.ocp import CycloidPolynomial
from quietarm.studies.bench.planned_jobs import jobs_of

THREE = ("residual", "energy", "peak_torque")
PROFILE = CycloidPolynomial(2)
SMALL = {"bound": 0.2, "population": 12, "generations": 3, "objectives": THREE}


OF_TWO = [name for name in PRESETS if PRESETS[name].residual_and_energy]
OF_ANY = [name for name in PRESETS if name not in OF_TWO and not PRESETS[name].needs]


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("name", OF_ANY)
def test_every_method_searches_three_objectives_and_its_seed_decides(name):
    alone = {"bound": 0.2, "evaluations": 36, "objectives": THREE}  # one candidate at a time
    asked = alone if PRESETS[name].population == 1 else SMALL
    one, same = (qa.search(SIXTH, PROFILE, algorithm=name, seed=2, **asked) for _ in range(2))
    assert exactly(one) == exactly(same)
    assert one.objectives == THREE
    of_generations = PRESETS[name].evaluations(12, 3, objectives=3)
    assert one.record.evaluations == asked.get("evaluations", of_generations)
    assert moocore.is_nondominated(one.objective_values).all()
    check_figures(one, name)


@pytest.mark.parametrize("name", OF_TWO)
def test_what_is_for_residual_and_energy_alone_says_so(name):
    refusal = f"{name} is for residual and energy alone, not for 3 objectives; give another"
    with pytest.raises(ValueError, match=refusal):
        qa.search(SIXTH, PROFILE, algorithm=name, bound=0.2, evaluations=20, objectives=THREE)
    problem = replace(problem_of("single-link-30deg-0.8s"), objectives=THREE)
    with pytest.raises(ValueError, match=refusal):
        Job(problem, name, budget=2000)


def test_steps_of_the_models_gradient_have_no_noise():
    refusal = "memetic takes steps of the model's gradient, which has no noise; give another"
    with pytest.raises(ValueError, match=refusal):
        qa.search(SIXTH, PROFILE, algorithm="memetic", bound=0.2, evaluations=500, noise=0.01)
    jobs, words = jobs_of(
        [problem_of("single-link-30deg-0.8s")], ["memetic", "gde3"], 1, 500, noise=0.01
    )
    assert [job.method for job in jobs] == ["gde3"]
    assert "memetic takes steps of the model's gradient, which has no noise: left out" in words[0]


def test_a_swarm_each_for_vepso():
    # a swarm for each objective (Parsopoulos and Vrahatis 2002)
    assert PRESETS["vepso"].evaluations(10, 5) == 100
    assert PRESETS["vepso"].evaluations(10, 5, objectives=4) == 200
    assert PRESETS["nsga2"].evaluations(10, 5, objectives=4) == 50


def test_an_algorithm_of_ones_own_searches_them_too():
    algorithm = NSGA3(get_reference_directions("das-dennis", 3, n_partitions=4), pop_size=15)
    front = qa.search(
        SIXTH, PROFILE, algorithm=algorithm, bound=0.2, generations=3, objectives=THREE
    )
    assert front.objective_values.shape[1] == 3


@pytest.mark.parametrize(("objectives", "parts"), [(3, 12), (4, 6)])
def test_directions_are_das_and_denniss_where_these_have_the_number(objectives, parts):
    number = comb(parts + objectives - 1, objectives - 1)
    ours = directions(number, objectives)
    pymoos = get_reference_directions("das-dennis", objectives, n_partitions=parts)
    assert sorted(map(tuple, ours.round(9))) == sorted(map(tuple, pymoos.round(9)))


@pytest.mark.parametrize("number", [2, 7, 50, 100])
def test_directions_are_as_many_as_individuals(number):
    for objectives in (2, 3, 4):
        rows = directions(number, objectives)
        assert rows.shape == (number, objectives)
        assert rows.sum(axis=1) == pytest.approx(1.0)
        assert len(np.unique(rows, axis=0)) == number


few = st.integers(0, 4).map(float)  # with ties


@pytest.mark.slow
@given(st.lists(st.tuples(few, few, few), min_size=1, max_size=25), st.integers(1, 7))
def test_what_enters_is_what_nothing_earlier_dominates(rows, size):
    candidates = np.array(rows)
    expected = [
        i for i, row in enumerate(candidates)
        if not any((earlier <= row).all() for earlier in candidates[:i])
    ]  # fmt: skip
    assert entering(np.empty((0, 3)), candidates).tolist() == expected
    profile = CycloidPolynomial(1)
    archive = Archive(MoveFunction(SIXTH, profile, bound=0.2, objectives=THREE))
    for begin in range(0, len(candidates), size):
        part = candidates[begin : begin + size]
        archive.add(part[:, :1], part, np.ones(len(part), dtype=bool))
    entries = archive.entries
    assert [number - 1 for number in entries.candidates] == expected
    assert entries.objectives().tolist() == candidates[expected].tolist()


def test_hypervolumes_of_known_boxes():
    unit = Scale(np.zeros(3), np.ones(3), np.zeros((1, 3)), whole=CORNER**3)
    # a point at the ideal dominates all; one in the middle a cube; two the sum less what both do
    assert HYPERVOLUME(np.zeros((1, 3)), unit) == pytest.approx(1.0)
    assert HYPERVOLUME(np.full((1, 3), 0.6), unit) == pytest.approx(0.5**3 / 1.1**3)
    two = np.array([[0.1, 0.6, 0.6], [0.6, 0.1, 0.1]])
    volume = 1.0 * 0.5 * 0.5 + 0.5 * 1.0 * 1.0 - 0.5 * 0.5 * 0.5
    assert HYPERVOLUME(two, unit) == pytest.approx(volume / 1.1**3)
    four = Scale(np.zeros(4), np.ones(4), np.zeros((1, 4)), whole=1.0)
    assert HYPERVOLUME(np.full((1, 4), 0.1), four) == pytest.approx(1.0)
    assert share_of_box(np.array([[1.0, 2.0, 3.0]]), (2.0, 4.0, 6.0)) == pytest.approx(1 / 8)


def test_a_thinned_surface_has_the_best_of_each_objective():
    sphere = np.abs(np.random.default_rng(0).normal(size=(400, 3)))
    points = 1 - sphere / np.linalg.norm(sphere, axis=1)[:, None]
    rows = thinned(points, 60)
    assert len(rows) == 60
    assert points[rows].min(axis=0).tolist() == points.min(axis=0).tolist()
    # covered evenly: nothing is farther from a chosen point than the extent's fifth
    distances = np.linalg.norm(points[:, None] - points[rows], axis=2).min(axis=1)
    assert distances.max() < 0.2


def test_a_file_of_two_objectives_says_nothing_of_more(tmp_path):
    front = qa.search(SIXTH, PROFILE, bound=0.2, population=12, generations=2)
    front.save(tmp_path / "front.json")
    document = json.loads((tmp_path / "front.json").read_text())
    assert "objectives" not in document
    assert "peaks" not in document["points"][0]
    assert not {"peaks", "believed"} & document["entries"].keys()
