"""A user's own function in the place of a task: searched, saved, compared, refused in a line."""

import dataclasses

import numpy as np
import pytest

import quietarm as qa
from quietarm.metaheuristics import PRESETS, Job, MoveFunction, NamedProblem, run_jobs
from quietarm.metaheuristics.search_run import default_of_function
from quietarm.ocp import FunctionFront, NoTaskError
from quietarm.studies.compare import compare_fronts

BOX = {"lower": [-5.0, -5.0], "upper": 5.0}
SIXTH = qa.PointToPoint(qa.SingleLinkManipulator(), target=qa.deg(30), duration=0.8)


def parabolas(x):
    """Return two objectives, whose front is the line from (0, 0) to (2, 0).

    On it f2 = (2 - sqrt(f1))^2.
    """
    return [x[0] ** 2 + x[1] ** 2, (x[0] - 2) ** 2 + x[1] ** 2]


def many(x):
    return np.column_stack([x[:, 0] ** 2 + x[:, 1] ** 2, (x[:, 0] - 2) ** 2 + x[:, 1] ** 2])


def limited(x):
    """Feasible where x_1 is 1 or less: there the front ends at (1, 1)."""
    return parabolas(x), [x[0] - 1]


def test_a_function_of_one_candidate_and_one_of_an_array_give_one_front():
    one = qa.search(parabolas, **BOX, evaluations=300, algorithm="es")
    array = qa.search(many, **BOX, evaluations=300, algorithm="es")
    assert one.record.evaluations == 300
    assert one.coefficients.tolist() == array.coefficients.tolist()
    first, second = one.objective_values.T
    np.testing.assert_array_less((2 - np.sqrt(first)) ** 2 - 1e-9, second)
    assert np.median(second - (2 - np.sqrt(first)) ** 2) < 0.1


def rows(x):
    """Of an array, but it makes rows of one candidate's numbers as well."""
    return [[np.sum(value**2), np.sum((value - 2) ** 2)] for value in x]


@pytest.mark.parametrize(
    ("function", "failed"),
    [(parabolas, 0), (many, 1), (rows, 1), (lambda x: many(np.atleast_2d(x)), 0)],
)
def test_no_candidate_is_evaluated_outside_the_budget(function, failed):
    shapes = []

    def counted(x):
        shapes.append(np.shape(x))
        return function(x)

    front = qa.search(counted, **BOX, evaluations=30, algorithm="es", reevaluate=2)
    assert shapes[0] == (2,)  # a function of an array may fail here, and evaluates nothing
    evaluated = sum(shape[0] if len(shape) == 2 else 1 for shape in shapes[failed:])
    assert evaluated == front.record.evaluations == 30


@pytest.mark.slow
@pytest.mark.parametrize("method", [name for name in PRESETS if name != "memetic"])
def test_every_method_calls_a_function_as_often_as_its_budget_says(method, tmp_path):
    calls = []

    def counted(x):
        calls.append(x)
        return parabolas(x)

    budget = 50 if method == "gp" else 410
    front = qa.search(counted, **BOX, evaluations=budget, algorithm=method, reevaluate=2)
    front.save(tmp_path / "front.json")
    front.save_csv(tmp_path / "front.csv")
    qa.pictures.front_figure([front])
    assert len(calls) == front.record.evaluations == budget
    problem = NamedProblem.of_function("mine", counted, **BOX, reference_front=front)
    calls.clear()
    Job(problem, method, 0, budget).run()
    assert len(calls) == budget


@pytest.mark.slow_after(2)
@pytest.mark.parametrize("method", ["es", "nsga2", "slsqp", "random"])
def test_constraints_hold_in_what_every_kind_of_method_finds(method):
    front = qa.search(
        limited, **BOX, constraints=["wall"], objectives=("way", "work"), units=("mm", "J"),
        evaluations=150, algorithm=method, seed=1,
    )  # fmt: skip
    assert front.points
    assert front.infeasible > 0
    assert (front.coefficients[:, 0] <= 1).all()
    assert list(front.columns()) == ["way_mm", "work_J", "a_1", "a_2"]


@pytest.mark.parametrize("least", [-np.inf, 0.0])  # a violation may be 0 wherever it is kept
def test_slsqp_has_the_motions_that_lie_on_a_constraint(least):
    """The least energy within a residual r is on the circle, at x_2 = sqrt(r): by Pythagoras."""

    def on_a_disc(x):
        return [x[1] ** 2, 4 - x[0] - x[1]], [max(x @ x - 1, least)]

    front = qa.search(
        on_a_disc, lower=[-2, -2], upper=2.0, constraints=["disc"], evaluations=150,
        algorithm="slsqp",
    )  # fmt: skip
    residuals, energies = front.objective_values.T
    best = 4 - np.sqrt(residuals) - np.sqrt(1 - residuals)
    assert (energies < best + 1e-4).sum() > 5
    assert (np.linalg.norm(front.coefficients, axis=1) <= 1).all()


def test_one_violation_of_many_candidates_may_be_a_row_of_numbers():
    front = qa.search(
        lambda x: (many(x), x[:, 0] - 1),
        **BOX,
        constraints=["wall"],
        evaluations=60,
        algorithm="es",
    )
    assert front.infeasible > 0
    assert (front.coefficients[:, 0] <= 1).all()


def test_attributes_of_the_function_say_what_no_argument_says():
    def sizes(x):
        return [abs(x[0]), abs(x[1]), -x.sum()]

    sizes.lower = (-1, -1)
    sizes.upper = (1, 2)
    sizes.objectives = ("one", "other", "gain")
    front = qa.search(sizes, evaluations=100, population=10)
    assert front.objectives == ("one", "other", "gain")
    assert front.objective_values[:, 2].min() < 0  # below zero is no error
    assert front.task.upper == (1.0, 2.0)
    assert front.task.name == "sizes"


def test_a_front_of_a_function_is_saved_loaded_compared_and_written_as_a_table(tmp_path):
    fronts = [qa.search(parabolas, **BOX, evaluations=100, population=10, seed=s) for s in (0, 1)]
    fronts[0].save(tmp_path / "front.json")
    loaded = qa.Front.load(tmp_path / "front.json")
    assert loaded == fronts[0]
    assert isinstance(loaded, FunctionFront)
    count = len(loaded.points)
    assert repr(loaded) == f"<FunctionFront by moead-de: {count} points of 100 candidates>"
    loaded.save_csv(tmp_path / "front.csv")
    assert (tmp_path / "front.csv").read_text().startswith("residual_m,energy_J,a_1,a_2\n")
    comparison = compare_fronts([loaded, fronts[1]])
    assert [len(group.runs) for group in comparison.groups] == [2]
    drawn = qa.pictures.front_figure(fronts)
    assert drawn.axes[0].get_xlabel() == "residual [m]"
    es = qa.search(parabolas, **BOX, evaluations=50, algorithm="es")
    drawn = qa.pictures.function_comparison_figure(compare_fronts([*fronts, es], fill=False))
    (axes,) = drawn.axes  # a line a method, with a band where it has seeds
    labels = [line.get_label() for line in axes.lines]
    assert labels == ["MOEA/D-DE", "(1+1)-ES with an archive"]
    assert len(axes.collections) == 1
    assert drawn.get_suptitle().startswith("Hypervolume gap: ")
    again = qa.search(parabolas, **BOX, evaluations=50, population=10, start=loaded)
    assert again.residuals.min() <= loaded.residuals.min()
    assert again.reference == loaded.reference  # so that their hypervolumes are of one area


def test_what_needs_a_task_says_so_in_one_line(tmp_path):
    front = qa.search(parabolas, **BOX, evaluations=50, population=10)
    move = qa.search(SIXTH, qa.CycloidPolynomial(2), bound=0.2, evaluations=50, population=10)
    needs = [
        lambda: front.task.plant,
        lambda: front.judged(front.points[0]),
        lambda: qa.polish_front(front),
        lambda: qa.ocp.interpolate_front(front),
        lambda: qa.evaluate_coefficients(front.task, front.points[0].coefficients),
        lambda: NamedProblem.of_front("mine", front).front().task.duration,
    ]
    for need in needs:
        with pytest.raises(NoTaskError, match="the function parabolas") as refused:
            need()
        assert "\n" not in str(refused.value)
    with pytest.raises(ValueError, match="one of a move"):
        compare_fronts([front, move])


def test_noise_and_evaluations_of_what_is_kept_are_those_of_tasks():
    calls = []

    def counted(x):
        calls.append(len(x))
        return many(x)

    noisy = qa.search(counted, **BOX, evaluations=120, population=20, noise=0.1, vectorized=True)
    assert sum(calls) == 120
    assert noisy.entries.believed
    first = noisy.points[0]  # the true values, not what was believed
    assert parabolas(first.coefficients) == pytest.approx([first.residual, first.energy])
    calls.clear()
    again = qa.search(counted, **BOX, evaluations=120, population=20, reevaluate=3, vectorized=True)
    assert sum(calls) == again.record.evaluations == 120
    assert len([count for count in calls if count < 20]) > 6


def test_threads_call_a_function_of_one_candidate_at_the_same_time():
    from threading import Barrier

    meets = Barrier(4, timeout=20)  # breaks unless four calls wait at once

    def slow(x):
        meets.wait()
        return parabolas(x)

    front = qa.search(
        slow, **BOX, evaluations=16, population=8, algorithm="random", threads=4, vectorized=False
    )
    alone = qa.search(parabolas, **BOX, evaluations=16, population=8, algorithm="random")
    assert front.coefficients.tolist() == alone.coefficients.tolist()


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("method", ["gp", "es", "nsga2"])
@pytest.mark.parametrize("stop", [KeyboardInterrupt, RuntimeError])
def test_what_was_evaluated_before_a_stop_is_in_the_front_of_the_run(method, threads, stop):
    calls = []

    def stops(x):
        calls.append(x.tolist())
        if len(calls) == 8:
            raise stop
        return parabolas(x)

    begun = []
    with pytest.raises((KeyboardInterrupt, ValueError)):
        qa.search(
            stops, **BOX, evaluations=240, algorithm=method, threads=threads, vectorized=False,
            reevaluate=3, begun=begun.append,
        )  # fmt: skip
    front = begun[0].front()
    assert front.record.evaluations == len(calls) - 1
    evaluated = calls[:7] + calls[8:]  # others may have gone on beside the one that stopped
    assert front.points
    assert all(list(point.coefficients) in evaluated for point in front.points)


@pytest.mark.usefixtures("what_is_made_up_is_forgotten")
@pytest.mark.parametrize(
    ("method", "budget", "steps"),
    [
        # the first 2 n + 4 of gp, and the first five of es, are one call
        ("gp", 12, [8, 9, 10, 11, 12]),
        ("es", 8, [5, 6, 7, 8]),
        ("slsqp", 2, [1, 2]),
        ("own", 3, [1, 2, 3]),
        ("nsga2", 25, [1, 2, 3]),  # the last generation is cut short
    ],
)
def test_progress_is_reported_by_methods_with_generations_and_without(method, budget, steps):
    class Own(qa.SearchMethod):
        name = "own"

        def run(self, function, seed, budget):
            while True:
                function([[0.5, 0.5]])

    seen = []
    qa.search(parabolas, **BOX, evaluations=budget, algorithm=method, report=seen.append)
    assert [progress.generation for progress in seen] == steps
    assert seen[-1].generation == seen[-1].generations
    assert seen[-1].evaluations == budget
    assert {progress.step for progress in seen} == {
        "generation" if method == "nsga2" else "candidate"
    }


def test_progress_is_not_reported_more_often_than_is_read():
    seen = []
    qa.search(parabolas, **BOX, evaluations=400, algorithm="es", report=seen.append)
    assert 190 < len(seen) < 300
    assert seen[-1].evaluations == 400


@pytest.mark.slow
def test_jobs_of_a_function_are_files_that_a_second_run_finds(tmp_path):
    reference = qa.search(parabolas, **BOX, evaluations=600, algorithm="es")
    problem = NamedProblem.of_function("parabolas", parabolas, **BOX, reference_front=reference)
    jobs = [Job(problem, method, 0, 60) for method in ("nsga2", "es")]
    done = run_jobs(jobs, tmp_path)
    assert run_jobs(jobs, tmp_path) == done
    with pytest.raises(ValueError, match="has none; give a search"):
        Job(problem, "epsilon")


def broken(x):
    return x[0] / 0.0 * np.array([1, 1]) if x[0] > 9 else 1 / 0


@pytest.mark.parametrize(
    ("function", "more", "words"),
    [
        (parabolas, {"lower": None}, "lower is missing"),
        (parabolas, {"upper": [1.0, 2.0, 3.0]}, "lower has 2 numbers and upper 3"),
        (parabolas, {"upper": -6}, "lower one that is less"),
        (parabolas, {"lower": -1.0}, "single numbers"),
        (parabolas, {"evaluations": None}, "evaluations is missing"),
        (parabolas, {"bound": 0.2}, "bound is for a task"),
        (parabolas, {"objectives": ["one"]}, "give two or more"),
        (parabolas, {"units": ["m"]}, "2 objectives have 1 units"),
        (parabolas, {"constraints": ["wall"]}, "one list of 2; with constraints give two"),
        (lambda x: (*parabolas(x),), {"constraints": ["wall"]}, "one tuple of 2; with const"),
        (limited, {}, r"no constraints are named; .* constraints=\['touch'\]"),
        (lambda x: (parabolas(x), x[0]), {}, "no constraints are named"),
        (lambda x: (parabolas(x), [x[0], x[1]]), {}, "no constraints are named"),
        (lambda x: (many(x), x), {"vectorized": True}, r"constraints=\['limit_1', 'limit_2'\]"),
        (parabolas, {"algorithm": "memetic"}, "a function has none"),
        (limited, {"algorithm": "moead", "constraints": ["wall"]}, "a function with constraints"),
        (parabolas, {"algorithm": "epsilon"}, "takes the gradient of a plant's model"),
        (parabolas, {"algorithm": "nsga2+polish"}, "give 'nsga2', and its front to polish_front"),
        (parabolas, {"noise": "5%"}, "as a number, such as 0.01 for 1 %"),
        (lambda x: [1.0, 2.0, 3.0], {}, r"objectives of shape \(3,\), not \(2,\)"),
        (lambda x: [1.0, [2.0, 3.0]], {}, r"objectives are \[1.0, \[2.0, 3.0\]\]; give numbers"),
        (parabolas, {"constraints": "wall"}, r"names, such as \['touch'\]"),
        (parabolas, {"vectorized": "yes"}, "give True for a function of many candidates"),
        (lambda x: [np.nan, 1.0], {}, "no finite numbers"),
        (lambda x: ["one", 1.0], {}, "give numbers"),
        (broken, {}, r"test_functions.py, line \d+\) fails: ZeroDivisionError"),
    ],
)
def test_refusals_are_one_line(function, more, words):
    options = {**BOX, "evaluations": 40, "population": 20, **more}
    with pytest.raises(ValueError, match=words) as refused:
        qa.search(function, **options)
    assert "\n" not in str(refused.value)


def test_what_is_of_a_function_is_refused_for_a_task():
    with pytest.raises(ValueError, match="lower is for a function"):
        qa.search(SIXTH, lower=[0.0], bound=0.2)


def test_a_candidate_that_fails_is_counted_and_comes_last():
    def fails_beside(x):
        return [np.nan, np.inf] if x[1] > 0 else parabolas(x)

    front = qa.search(fails_beside, **BOX, evaluations=100, population=20)
    assert 0 < front.failed < 100
    assert (front.coefficients[:, 1] <= 0).all()


WITH_POPULATION = [name for name, preset in PRESETS.items() if not preset.is_function]


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.slow] * (PRESETS[name].needs == "numba"))
        for name in WITH_POPULATION
        if name != "memetic"  # it takes the gradient of a model
    ],
)
def test_a_first_population_may_fail_as_a_whole(name):
    """A simulator that is mended meanwhile, or a box whose first candidates all fail."""
    calls = []

    def fails_at_first(x):
        calls.append(x)
        return [np.nan, np.nan] if len(calls) <= 12 else parabolas(x)

    front = qa.search(fails_at_first, **BOX, evaluations=80, population=10, algorithm=name)
    assert front.failed == 12
    assert front.points


def test_few_candidates_have_a_small_population_unless_it_is_the_papers():
    # 50 generations, 10 individuals at least, and the preset's from 5,000 candidates on
    sizes = [PRESETS["nsga2"].population_for(count) for count in (200, 1_000, 5_000, 40_000)]
    assert sizes == [10, 20, 100, 100]
    assert PRESETS["nsga2-paper"].population_for(200) == 200
    front = qa.search(parabolas, **BOX, evaluations=60, algorithm="nsga2")
    assert front.record.settings["population"] == 10


def test_an_energy_in_numpy_is_that_of_the_simulated_samples():
    profile = qa.CycloidPolynomial(3)

    def absolute(samples):
        return samples.integral(np.abs(samples.power))

    candidates = np.random.default_rng(0).uniform(-0.2, 0.2, (4, 3))
    own = qa.metaheuristics.OwnEnergyFunction(SIXTH, profile, bound=0.2, energy=absolute)
    known = MoveFunction(SIXTH, profile, bound=0.2)(candidates)[0]
    # the same integral but for the zeros of the power, which MoveFunction resolves
    np.testing.assert_allclose(own(candidates)[0], known, rtol=2e-3)

    def sway(samples):
        assert samples.W.shape == samples.dW.shape == (len(samples.torque), 1, len(samples.time))
        return samples.integral((samples.tips**2).sum(axis=1))

    front = qa.search(SIXTH, profile, bound=0.2, energy=sway, evaluations=60, population=10)
    assert front.task.name == "sway of single-link"
    refused = {
        "give one energy for each of": lambda samples: samples.power,
        r"test_functions.py, line \d+\) fails: ZeroDivisionError": lambda samples: 1 / 0,
        "no finite numbers": lambda samples: np.full(len(samples.torque), np.nan),
    }
    for words, energy in refused.items():
        with pytest.raises(ValueError, match=words):
            qa.search(SIXTH, profile, bound=0.2, energy=energy, evaluations=20, population=10)
    with pytest.raises(TypeError, match="an Energy to the task"):
        qa.search(SIXTH, profile, bound=0.2, energy=qa.CopperLoss(0.1), evaluations=20)


def test_the_path_of_a_candidate_is_that_of_its_plan():
    profile = qa.CycloidPolynomial(2)
    sent = qa.motion_of(SIXTH, profile, [0.1, -0.05], step=2e-3, after=0.1)
    assert len(sent.time) == 451
    plan = qa.evaluate_coefficients(SIXTH, [0.1, -0.05], profile=profile)
    of_plan = plan.candidate.sample(sent.time[1:400]).joint
    np.testing.assert_allclose(sent.angle[1:400], of_plan[:, 0], atol=1e-9)
    np.testing.assert_allclose(sent.acceleration[1:400], of_plan[:, 2], atol=1e-6)
    for at_end in (sent, qa.motion_of(SIXTH, profile, [0.1, -0.05], step=3e-3)):
        assert at_end.angle[-1] == pytest.approx(SIXTH.target)  # 0.8 s are no multiple of 3 ms
        assert at_end.speed[-1] == 0.0
    for step in (5.0, 1e-12):
        with pytest.raises(ValueError, match=f"step is {step:g} s, and the motion takes 0.8 s"):
            qa.motion_of(SIXTH, profile, [0.1, -0.05], step=step)


def test_a_surrogate_finds_with_few_candidates_what_others_do_not():
    found = {
        method: qa.search(limited, **BOX, constraints=["wall"], evaluations=40, algorithm=method)
        for method in ("gp", "nsga2")
    }
    again = qa.search(limited, **BOX, constraints=["wall"], evaluations=40, algorithm="gp")
    assert again == found["gp"]
    comparison = compare_fronts(list(found.values()), fill=False)
    surrogate, population = (run.scores["hypervolume"] for run in comparison.runs)
    assert surrogate > population


def wavy(x):
    """Return two objectives whose sum is from 2 to 4 on the front, and above 100 in most places."""
    way = np.sum(1 - np.cos(3 * x[1:])) + x[1:] @ x[1:]
    return [x[0] ** 2 + way, (x[0] - 2) ** 2 + way]


def asked_by_a_surrogate(function, evaluations, training):
    asked = []

    def kept(x):
        asked.append(np.array(x))
        return function(x)

    qa.search(
        kept, lower=[-5.0] * 4, upper=5.0, evaluations=evaluations, algorithm="gp", seed=2,
        settings={"training": training, "pool": 100},
    )  # fmt: skip
    return np.array(asked[-evaluations:])


def test_a_surrogate_of_many_candidates_stays_near_the_front_though_it_forgets_what_is_far():
    late = asked_by_a_surrogate(wavy, 260, training=20)[160:]
    assert np.median([sum(wavy(x)) for x in late]) < 10  # 123 in version 2.1.0


def test_a_surrogate_of_few_candidates_asks_for_those_of_before():
    # from version 2.1.0: packed runs of 200 candidates have to be those of a new run
    last = asked_by_a_surrogate(wavy, 50, training=20)[-2:]
    before = [
        [-0.5021024931636475, 2.302636404860391, -4.095006981090488, -4.897832508435585],
        [-3.660075983616302, 4.344788460787315, -2.958877044091226, 2.160049753317761],
    ]
    np.testing.assert_allclose(last, before, rtol=1e-9)


@pytest.mark.parametrize(("count", "method"), [(1_000, "gp"), (1_001, "moead-de")])
def test_the_method_of_a_function_depends_on_the_number_of_candidates(count, method):
    assert default_of_function(count) == method
    assert default_of_function(count, needs_population=10) == "moead-de"


def test_functions_equal_each_other_by_what_they_state():
    front = qa.search(parabolas, **BOX, evaluations=40, population=10)
    other = dataclasses.replace(front.function, name="other")
    assert other != front.function
