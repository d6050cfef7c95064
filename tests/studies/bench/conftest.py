"""Jobs of one problem, done once for the tests of a bench."""

import pytest
from bench_problems import METHODS, NAME, SMALL

from quietarm.metaheuristics import Job, run_jobs


@pytest.fixture(scope="session")
def jobs():
    searches = [Job(NAME, method, seed, 200, SMALL if "nsga2" in method else None)
                for seed in range(5) for method in METHODS]  # fmt: skip
    return [*searches, *(Job(NAME, "epsilon", seed, settings={"points": 8}) for seed in range(5))]


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("bench")


@pytest.fixture(scope="session")
def fronts(jobs, folder):
    return run_jobs(jobs, folder)
