"""What the tests of `quietarm.ocp.solvers` share."""

import pytest
from quietarm.ocp import CycloidPolynomial
from quietarm.ocp.solvers.program import Program


@pytest.fixture(params=["single link", "arm", "two links"])
def task(request, tasks):
    return tasks[request.param]


@pytest.fixture(scope="session")
def program():
    """The program of a task, in few words."""

    def of(task, *, terms=6, steps=48):
        return Program(task, CycloidPolynomial(terms), steps)

    return of
