"""Methods of one's own among others: counted alike, and failed runs where they are at fault."""

import os
import sys
import threading

import numpy as np
import pytest
from bench_problems import NAME, called

from quietarm.metaheuristics import Job, LostJobsError, run_jobs
from quietarm.metaheuristics.methods.user_method import digest_of

BUDGET = 60


class Asked:
    """Random candidates, asked and told."""

    def __init__(self, rows=25):
        self.rows = rows

    def setup(self, function, seed):
        self.function = function
        self.random = np.random.default_rng(seed)
        self.told = 0

    def ask(self):
        lower, upper = self.function.lower, self.function.upper
        return self.random.uniform(lower, upper, (self.rows, len(lower)))

    def tell(self, candidates, objectives, violations):
        assert objectives.shape == (len(candidates), 2)
        assert violations.shape == (len(candidates), 0)
        self.told += len(candidates)


def test_an_object_that_is_asked_and_told_counts_as_a_function_does(tmp_path):
    method = Asked()
    jobs = [Job(NAME, method, seed, BUDGET) for seed in (0, 1)]
    jobs += [Job(NAME, called, seed, BUDGET) for seed in (0, 1)]
    fronts = list(run_jobs(jobs, tmp_path).values())
    assert [front.record.evaluations for front in fronts] == [BUDGET] * 4
    assert [front.points for front in fronts[:2]] == [front.points for front in fronts[2:]]
    assert fronts[0].points != fronts[1].points
    assert fronts[0].record.method == "Asked"
    assert vars(method) == {"rows": 25}  # each job had a copy


def test_runs_of_an_object_whose_code_or_state_changed_are_told_apart():
    class Changed(Asked):
        def ask(self):
            return super().ask() / 2

    Changed.__name__ = Changed.__qualname__ = "Asked"
    assert digest_of(Asked()) == digest_of(Asked())
    assert len({digest_of(Asked()), digest_of(Asked(30)), digest_of(Changed())}) == 3


def dies(function, seed, budget):
    raise RuntimeError("it fell\nover")


def exits(function, seed, budget):
    sys.exit(3)


def ends_as_a_generator_does(function, seed, budget):
    raise GeneratorExit


def needs_too_much(function, seed, budget):
    raise MemoryError


def returns_candidates(function, seed, budget):
    return np.zeros((3, 2))


def yields(function, seed, budget):
    yield np.zeros((3, 2))


async def awaits(function, seed, budget):
    await function


def asks_nothing(function, seed, budget):
    while True:
        function(np.empty((0, 2)))


def asks_nan(function, seed, budget):
    function(np.full((3, 2), np.nan))


def asks_strings(function, seed, budget):
    function([["a", "b"]])


def asks_outside(function, seed, budget):
    function([[0.0, 0.1], [0.9, 0.0]])


def asks_other_columns(function, seed, budget):
    function(np.zeros((3, 5)))


def asks_one_row(function, seed, budget):
    function(np.zeros(2))


def widens_the_box(function, seed, budget):
    function.upper[:] = 9.0


class AsksNone(Asked):
    def ask(self):
        return None


class AsksNothing(Asked):
    def ask(self):
        return np.empty((0, 2))


class IsNotTold(Asked):
    def tell(self):
        pass


class HoldsALock(Asked):
    def __init__(self):
        self.lock = threading.Lock()


FAULTS = {
    dies: "RuntimeError: it fell over",
    exits: "it calls sys.exit(3), which would end quietarm as well",
    ends_as_a_generator_does: "GeneratorExit",
    needs_too_much: "MemoryError",
    returns_candidates: "it asked for no candidate; call function(candidates)",
    yields: "it is a generator, of which nothing runs; call function(candidates) in place of yield",
    awaits: "it is a generator, of which nothing runs",
    asks_nothing: "it asked for no candidate",
    asks_nan: "a_1 of candidate 1 is nan, not from -0.2 to 0.2",
    asks_strings: "coefficients are [['a', 'b']]; give a row of numbers for each motion",
    asks_outside: "a_1 of candidate 2 is 0.9, not from -0.2 to 0.2; clip candidates",
    asks_other_columns: "coefficients have shape (3, 5); give (motions, 2)",
    asks_one_row: "coefficients have shape (2,); give (motions, 2)",
    widens_the_box: "assignment destination is read-only",
    AsksNone(): "ask() returns None; return candidates, one a row",
    AsksNothing(): "it asked for no candidate",
    IsNotTold(): "TypeError: ",
    HoldsALock(): "TypeError: cannot pickle",
}


@pytest.mark.slow
def test_a_method_at_fault_is_a_failed_run_with_its_reason_and_the_rest_goes_on(tmp_path):
    jobs = [*(Job(NAME, method, 0, BUDGET) for method in FAULTS), Job(NAME, called, 0, BUDGET)]
    with pytest.raises(LostJobsError) as caught:
        run_jobs(jobs, tmp_path)
    assert list(caught.value.fronts) == jobs[-1:]
    failures = caught.value.failures
    assert list(failures) == [job.name for job in jobs[:-1]]
    for job, words in zip(jobs, FAULTS.values(), strict=False):
        assert words in failures[job.name]
        assert "\n" not in failures[job.name]


def test_a_budget_ends_what_goes_on_after_any_exception():
    def stubborn(function, seed, budget):
        while True:
            try:
                function(np.zeros((7, 2)))
            except Exception:
                continue

    assert Job(NAME, stubborn, 0, BUDGET).run().record.evaluations == BUDGET


def test_of_a_huge_array_only_the_budget_is_evaluated():
    def huge(function, seed, budget):
        function(np.broadcast_to(np.zeros((1, 2)), (10**9, 2)))  # as 16 GB of numbers

    assert Job(NAME, huge, 0, BUDGET).run().record.evaluations == BUDGET


def test_what_is_no_method_is_refused_before_anything_runs():
    for value in (3, None, [called]):
        with pytest.raises(
            ValueError,
            match=r"^method is .*; give a name, such as 'nsga2', a "
            r"function",
        ):
            Job(NAME, value, 0, BUDGET)
    with pytest.raises(ValueError, match=r"give an object, such as Asked\(\), not its class"):
        Job(NAME, Asked, 0, BUDGET)


@pytest.mark.parametrize("method", ["nsga2", "memetic", "moead-de", "mo-cma-es", "slsqp", "epsilon",
                                    "weighted:ipopt", "multistart", "gde3+polish"])  # fmt: skip
def test_settings_that_do_not_exist_are_refused_before_anything_runs(method):
    with pytest.raises(ValueError, match=r"has no setting 'colour' \(it has: "):
        Job(NAME, method, settings={"colour": 1})


@pytest.mark.parametrize(
    ("method", "settings", "words"),
    [
        ("epsilon", {"points": 1}, "points is 1; give a whole number from 2 up"),
        ("epsilon", {"starts": 3}, "epsilon has no setting 'starts'"),
        ("weighted", {"population": 10}, "weighted has no setting 'population'"),
        ("multistart", {"starts": 0}, "starts is 0"),
        ("memetic", {"gradient_points": 1}, "gradient_points is 1"),
        ("memetic", {"gradient_iterations": 0.5}, "gradient_iterations is 0.5"),
        ("mo-cma-es", {"first_step": 0}, "first_step is 0"),
        ("slsqp", {"population": 10}, "slsqp has no population; leave it out"),
        (called, {"rows": 3}, "called takes no settings here"),
        (Asked(), {"rows": 3}, "Asked takes no settings here"),
    ],
)
def test_values_of_settings_are_refused_before_anything_runs(method, settings, words):
    budget = None if isinstance(method, str) else BUDGET
    with pytest.raises(ValueError, match=words):
        Job(NAME, method, 0, budget, settings)


@pytest.mark.slow
def test_a_method_that_kills_its_worker_takes_no_other_run_with_it(tmp_path):
    def kills(function, seed, budget):
        if seed == 1:
            os._exit(7)
        called(function, seed, budget)

    jobs = [Job(NAME, kills, seed, BUDGET) for seed in range(7)]
    with pytest.raises(LostJobsError, match="its worker died twice; 6 jobs are done") as caught:
        run_jobs(jobs, tmp_path, workers=2)
    assert list(caught.value.fronts) == [job for job in jobs if job.seed != 1]


@pytest.mark.slow
def test_what_cannot_be_sent_to_a_worker_is_a_failed_run(tmp_path):
    lock = threading.Lock()

    def locked(function, seed, budget):
        with lock:
            called(function, seed, budget)

    jobs = [Job(NAME, locked, 0, BUDGET), *(Job(NAME, called, seed, BUDGET) for seed in (0, 1))]
    with pytest.raises(LostJobsError, match=r"cannot be sent to a worker .* one worker") as caught:
        run_jobs(jobs, tmp_path, workers=2)
    assert list(caught.value.fronts) == jobs[1:]
