"""What the tests of `ocp.program` share: a task of each plant, and problems of tasks."""

import pytest

from ocp import CycloidPolynomial
from ocp.program.problem import Problem
from ocp.program.task_program import TaskProgram


@pytest.fixture(params=["single link", "arm", "two links"])
def task(request, tasks):
    return tasks[request.param]


@pytest.fixture(scope="session")
def problem():
    """What a problem is made of, in few words."""

    def of(task, limits, bound=None, *, terms=6, steps=60):
        return Problem(TaskProgram(task, CycloidPolynomial(terms), steps), limits, bound)

    return of
