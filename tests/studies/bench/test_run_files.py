"""A run's file is believed if it is what the bench wrote for its job."""

import json
import shutil

import pytest
from bench_problems import NAME
from saved_files import renew_checksum

import quietarm as qa
from quietarm.metaheuristics import Job, NamedProblem, finished_jobs, problem_of, run_jobs

JOBS = [Job(NAME, "random", seed, 200) for seed in (0, 1)]
JOB = JOBS[0]


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """The folder of two runs."""
    folder = tmp_path_factory.mktemp("runs")
    run_jobs(JOBS, folder)
    return folder


@pytest.fixture
def runs(written, tmp_path):
    """A copy of it, to be changed."""
    return shutil.copytree(written, tmp_path / "runs")


def path_of(job, folder):
    return folder / f"{job.name}.json"


def change(folder, edit, of_2_0=False):
    """Edit a run's document; or one that names its job as 2.0.0 did, and has a checksum again."""
    path = path_of(JOB, folder)
    document = json.loads(path.read_text())
    edit(document)
    if of_2_0:
        settings = document["record"]["settings"]
        del settings["job"]
        settings["checksum"] = "of the job and of all entries"
        renew_checksum(document)
    path.write_text(json.dumps(document))


def without_newest_entry(document):
    del document["task"]["torque_speed"]


def lower_energies(document):
    for point in document["points"]:
        point["energy"] *= 0.9


def lower_residuals(document):
    for point in document["points"]:
        point["residual"] *= 0.9


def better_way(document):
    document["entries"]["energies"][0] *= 0.9


def earlier_way(document):
    document["entries"]["candidates"][-1] -= 1


def more_candidates(document):
    document["entries"]["candidates"][-1] = 201


def fewer_evaluations(document):
    document["history"][-1]["evaluations"] = 20
    document["record"]["evaluations"] = 20


def less_time(document):
    for mark in document["history"]:
        mark["seconds"] *= 0.1
    document["record"]["seconds"] *= 0.1


def other_seed(document):
    document["record"]["seed"] = 7


CHANGES = [
    lower_energies, lower_residuals, better_way, earlier_way, fewer_evaluations, less_time,
    other_seed,
]  # fmt: skip


@pytest.mark.parametrize("edit", CHANGES)
def test_a_run_that_was_changed_is_refused(runs, edit):
    change(runs, edit)
    with pytest.raises(ValueError, match=r"was changed since it was written.*delete"):
        run_jobs(JOBS, runs)


@pytest.mark.parametrize("move", [shutil.copy, shutil.move])
def test_another_run_in_its_place_is_refused(runs, move):
    move(path_of(JOBS[1], runs), path_of(JOB, runs))
    with pytest.raises(ValueError, match="is not what a bench wrote for random, seed 0"):
        run_jobs([JOB], runs)
    # another method's, with the budget and seed of the job
    better = Job(NAME, "nsga2", 0, 200, {"population": 20})
    run_jobs([better], runs)
    shutil.copy(path_of(better, runs), path_of(JOB, runs))
    with pytest.raises(ValueError, match="is not what a bench wrote for random, seed 0"):
        run_jobs([JOB], runs)


def test_what_the_bench_wrote_is_believed_and_what_is_deleted_is_done_again(runs):
    before = finished_jobs(JOBS, runs)
    change(runs, lambda document: None)  # other white space
    assert finished_jobs(JOBS, runs) == before
    path_of(JOB, runs).unlink()
    assert run_jobs(JOBS, runs)[JOB].points == before[JOB].points


def test_a_run_of_2_0_that_has_no_digest_of_its_job_is_loaded(runs):
    before = finished_jobs(JOBS, runs)
    change(runs, lambda document: None, of_2_0=True)
    after = finished_jobs(JOBS, runs)
    assert after[JOBS[1]] == before[JOBS[1]]
    assert (after[JOB].points, after[JOB].history) == (before[JOB].points, before[JOB].history)


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (lower_energies, "point 1 of .* states energy"),
        (lower_residuals, "point 1 of .* states residual"),
        (better_way, r"candidate \d+ states energy"),
        (more_candidates, "it states candidate 201 of 200"),
        (fewer_evaluations, r"it states candidate \d+ of 20"),
        (other_seed, "states seed 7, and its job has 0"),
    ],
)
def test_what_it_says_of_itself_is_compared(runs, edit, words):
    change(runs, edit, of_2_0=True)
    with pytest.raises(ValueError, match=f"{words}.*; delete that file, and its run is done again"):
        finished_jobs(JOBS, runs)


def test_a_run_is_believed_whatever_is_newer_than_its_file(runs):
    before = finished_jobs(JOBS, runs)

    def edit(document):
        without_newest_entry(document)
        renew_checksum(document)

    change(runs, edit)
    assert finished_jobs(JOBS, runs)[JOB].points == before[JOB].points


@pytest.mark.parametrize("edit", [lambda document: document.pop("checksum"), other_seed])
def test_a_run_that_names_its_job_needs_the_checksum_of_its_file(runs, edit):
    change(runs, edit)
    with pytest.raises(ValueError, match="was changed since it was written"):
        finished_jobs(JOBS, runs)


def test_the_command_refuses_a_changed_run_in_one_line(call, runs):
    change(runs, lower_energies)
    line = f"bench {NAME} --methods random --runs 2 --evaluations 200 --output {runs}"
    code, out, err = call(line)
    assert (code, out) == (2, "")
    assert "was changed since it was written" in err.splitlines()[-1]
    assert [path.name for path in runs.iterdir()] == [NAME]  # nothing was written


def test_runs_measured_against_another_reference_are_refused(tmp_path):
    reference = problem_of(NAME).fronts()[0]
    for points in (reference.points, reference.points[::2]):
        front = qa.Front(
            reference.task, reference.profile, points, reference.record, reference.reference
        )
        job = Job(NamedProblem.of_front("mine", front), "random", 0, 100)
        if points is reference.points:
            run_jobs([job], tmp_path)
        else:
            with pytest.raises(ValueError, match="measured against another reference front"):
                run_jobs([job], tmp_path)
