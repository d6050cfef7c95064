"""Fixtures that the tests of `quietarm.ocp.solvers` share."""

import pytest

from quietarm.ocp import CycloidPolynomial
from quietarm.ocp.solvers.problem import Program


@pytest.fixture(params=["single link", "arm", "two links"])
def task(request, tasks):
    return tasks[request.param]


@pytest.fixture(scope="session")
def transcribe():
    """A task on its steps, in few words."""

    def of(task, *, terms=6, steps=48):
        return Program(task, CycloidPolynomial(terms), steps)

    return of
