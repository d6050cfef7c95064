"""How a solve ended, in words."""

import pytest
from quietarm.ocp import SolveStatus


@pytest.mark.parametrize(
    ("ipopt", "status"),
    [
        # IPOPT's ApplicationReturnStatus, in casadi's spelling.
        ("Solve_Succeeded", SolveStatus.OPTIMAL),
        ("Solved_To_Acceptable_Level", SolveStatus.ACCEPTABLE),
        ("Infeasible_Problem_Detected", SolveStatus.INFEASIBLE),
        ("Not_Enough_Degrees_Of_Freedom", SolveStatus.INFEASIBLE),
        ("Maximum_Iterations_Exceeded", SolveStatus.ITERATION_LIMIT),
        ("Restoration_Failed", SolveStatus.NUMERICAL_TROUBLE),
        ("Invalid_Number_Detected", SolveStatus.NUMERICAL_TROUBLE),
        ("Internal_Error", SolveStatus.NUMERICAL_TROUBLE),
        ("a status of a later IPOPT", SolveStatus.NUMERICAL_TROUBLE),
    ],
)
def test_ipopts_status_is_translated(ipopt, status):
    assert SolveStatus.from_ipopt(ipopt) is status


def test_only_an_optimum_is_solved():
    solved = {status for status in SolveStatus if status.solved}
    assert solved == {SolveStatus.OPTIMAL, SolveStatus.ACCEPTABLE}


@pytest.mark.parametrize("status", SolveStatus)
def test_a_status_is_found_again_by_its_word_in_a_file(status):
    assert SolveStatus(status.value) is status
