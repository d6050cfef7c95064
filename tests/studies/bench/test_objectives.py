"""A bench with peaks among the objectives, and with noise."""

from dataclasses import replace

import numpy as np
import pytest
from bench_problems import NAME

from quietarm.metaheuristics import Job, NamedProblem, problem_of, run_jobs
from quietarm.metaheuristics.run_files import JOB
from quietarm.metaheuristics.score import filled, objectives
from quietarm.ocp import epsilon_front
from quietarm.studies.bench.planned_jobs import jobs_of, problems_of, with_references
from quietarm.studies.bench.results import Results
from quietarm.studies.compare import compare_fronts
from quietarm.studies.compare.front_report import fronts_report
from quietarm.views.pictures import draw_parallel, draw_peak, front_figure

THREE = ("residual", "energy", "peak_torque")


def sampling(function, seed, budget):
    rng = np.random.default_rng(seed)
    while True:
        function(rng.uniform(function.lower, function.upper, (25, len(function.lower))))


@pytest.fixture(scope="module")
def problem():
    plain = problem_of(NAME)
    reference = epsilon_front(plain.task, plain.profile, bound=plain.bound, points=40,
                              objectives=THREE)  # fmt: skip
    return replace(plain, name="three", objectives=THREE, reference_front=reference)


@pytest.fixture(scope="module")
def runs(problem, tmp_path_factory):
    jobs = [
        *(Job(problem, "nsga3", seed, 400, {"population": 20}) for seed in range(2)),
        Job(problem, "nsga3", 0, 400, {"population": 20}, noise=0.02, reevaluate=2),
        Job(problem, sampling, 0, 400, noise=0.02),
        Job(problem, "epsilon", settings={"points": 9}),
    ]
    folder = tmp_path_factory.mktemp("three")
    done = run_jobs(jobs, folder)
    assert run_jobs(jobs, folder) == done  # the files are taken as they are
    return done


@pytest.mark.slow
def test_every_run_has_all_objectives_and_is_measured_by_them(runs, problem):
    for job, front in runs.items():
        assert front.objectives == THREE
        assert JOB in front.record.settings
        scores = problem.reference().scores(objectives(front))
        assert 0 < scores["hypervolume"] < 1.1
        assert filled(front).shape[1] == 3
        assert len(filled(front)) > len(front.points)
        if job.budget is not None:
            assert front.record.evaluations == job.budget
    table = Results.of_jobs(runs).table
    assert table["missing"].between(-0.1, 1).all()
    assert np.isfinite(table["igd_plus"]).all()


@pytest.mark.slow
def test_noise_stands_in_the_name_of_a_method_and_of_its_file(runs):
    labels = [job.label for job in runs]
    assert labels[2] == "nsga3(population=20,noise=0.02,reevaluate=2)"
    assert labels[3] == "sampling(noise=0.02)"
    assert len(Results.of_jobs(runs).methods) == 4


@pytest.mark.slow
def test_a_named_problem_with_peaks_has_a_reference_and_another_name(tmp_path):
    (with_torque,) = with_references(problems_of([NAME], THREE), tmp_path)
    assert (with_torque.name, with_torque.objectives) == (f"{NAME}-peak-torque", THREE)
    assert with_torque.front().objectives == THREE
    (same,) = problems_of([NAME], ("residual", "energy"))
    assert same == problem_of(NAME)
    jobs, words = jobs_of([same], ["random", "epsilon"], 1, 100, noise=0.01, reevaluate=2)
    assert [job.noise for job in jobs] == [0.01, 0.0]
    assert words == ["epsilon has no noise: its gradient is that of the model"]


@pytest.mark.slow
def test_the_torque_problem_is_measured_by_its_six_fronts_together():
    problem = problem_of("single-link-30deg-0.8s-torque")
    X, F = problem.optimum()
    assert problem.reference().front.objectives == THREE
    assert objectives(problem.front()).tolist() == F.tolist()
    assert len(X) == len(F) > 1000


@pytest.mark.slow
def test_fronts_of_the_same_objectives_are_compared_and_others_refused(runs, tmp_path):
    fronts = list(runs.values())
    comparison = compare_fronts([fronts[0], fronts[-1]], ["searched", "by gradient"])
    assert comparison.objectives == THREE
    assert (len(comparison.corner), len(comparison.extent)) == (3, 3)
    searched, exact = (group.runs[0].scores for group in comparison.groups)
    assert 0 < searched["hypervolume"] < 1
    assert 0 < exact["hypervolume"] < 1
    report = fronts_report([comparison], [[]])
    for path, write in report.files(tmp_path):
        write(path)
    text = (tmp_path / "report.md").read_text()
    assert "The indicators are of residual, energy, peak-torque;" in text
    assert "0.07319 N m" in text
    plain = problem_of(NAME).fronts()[0]
    with pytest.raises(ValueError, match=r"plain has the objectives residual, energy, and s.*; co"):
        compare_fronts([fronts[0], plain], ["searched", "plain"])


@pytest.mark.slow
def test_pictures_have_a_peak_as_colour_and_an_axis_for_each_objective(runs, problem):
    fronts = list(runs.values())
    ax = draw_peak(fronts[:2])
    assert ax.figure.axes[1].get_ylabel() == "peak joint torque [N m]"
    shown = np.vstack([marks.get_offsets() for marks in ax.collections])
    assert len(shown) == sum(len(front.points) for front in fronts[:2])
    assert shown[:, 1].min() == min(front.energies.min() for front in fronts[:2])
    lines = draw_parallel([fronts[0]]).get_lines()
    assert len(lines) == len(fronts[0].points)
    heights = np.array([line.get_ydata() for line in lines], dtype=float)
    assert (heights.min(axis=0).tolist(), heights.max(axis=0).tolist()) == ([0.0] * 3, [1.0] * 3)
    assert len(front_figure([fronts[-1]]).axes) == 2  # with the scale of the colours
    four = ("residual", "energy", "peak_torque", "peak_deflection")
    task = problem.task
    front = epsilon_front(task, problem.profile, bound=0.2, points=4, objectives=four)
    assert len(front_figure([front]).axes) == 3
    with pytest.raises(ValueError, match="peak is 1, and the front has 1; give one from 0"):
        draw_peak(fronts[:1], peak=1)


@pytest.mark.slow
def test_a_problem_of_a_front_has_its_objectives(runs):
    front = next(iter(runs.values()))
    problem = NamedProblem.of_front("mine", front)
    assert problem.objectives == THREE
    assert problem.pymoo().n_obj == 3
    assert problem.recorded(budget=10).units == ("m", "J", "N m")
