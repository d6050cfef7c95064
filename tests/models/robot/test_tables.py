"""Tables of a robot on its path, between their nodes, against the robot's equations."""

import dataclasses

import casadi as ca
import numpy as np
import pytest
from robots import END, START, straight, ur5_with_bar

import quietarm as qa
from quietarm.models import Base, JointMotion
from quietarm.models.robot.on_path.path_tables import ACCURACY, tables_of
from quietarm.models.robot.on_path.reduction import OF_MODES, OF_TORQUES, Reduction

BETWEEN = np.random.default_rng(5).uniform(-0.05, 1.05, 60)


def _bent():
    """Through six waypoints."""
    beside = np.random.default_rng(3).uniform(-0.15, 0.15, (6, 6))
    beside[[0, -1]] = 0.0
    return qa.GeometricPath.through(START + np.linspace(0, 1, 6)[:, None] * (END - START) + beside)


PATHS = {"line": straight, "six waypoints": _bent}


@pytest.fixture(scope="module", params=PATHS)
def path(request):
    return PATHS[request.param]()


def _values(tables, table):
    """Return a table's values at the places, by CasADi as the solvers evaluate it."""
    place = ca.SX.sym("s")
    entries = tables.at(place).values(table)
    function = ca.Function("table", [place], [ca.vertcat(*entries.ravel())])
    return function(BETWEEN[None]).full().T.reshape(len(BETWEEN), *entries.shape)


@pytest.mark.slow
def test_tables_are_the_equations_between_their_nodes(path):
    """Within 1e-9 of the largest value of each coefficient, or of what matters beside it."""
    robot = ur5_with_bar()
    exact = Reduction(robot.dynamics, robot.tip_place, path, range(2)).at(BETWEEN)
    tables = tables_of(robot, path)
    push = np.abs(exact.modes["a"]).max()
    force = np.abs(exact.torques["g"]).max()
    square = tables.frequencies[0] ** 2
    for names, found, wanted, matters in (
        (OF_MODES, tables.modes, exact.modes, square),
        (OF_TORQUES, tables.torques, exact.torques, force * square / push),
    ):  # fmt: skip
        for name in names:
            error = np.abs(_values(tables, found[name]) - wanted[name]).max()
            assert error <= ACCURACY * max(np.abs(wanted[name]).max(), 1e-3 * matters), name
    assert _values(tables, tables.tips) == pytest.approx(exact.tips, abs=1e-8)


def test_numbers_arrays_and_symbols_have_the_same_values():
    tables = tables_of(ur5_with_bar(), straight())
    table = tables.torques["a"]
    wanted = _values(tables, table)
    in_array = tables.at(BETWEEN.reshape(6, 10)).values(table)
    matrix = ca.MX.sym("s", 6, 10)
    by_matrix = ca.Function("matrix", [matrix], [*tables.at(matrix).values(table)])
    for number, column in enumerate(wanted.T):
        assert in_array[number].ravel() == pytest.approx(column, rel=1e-12)
        alone = [tables.at(float(place)).values(table)[number] for place in BETWEEN[:3]]
        assert alone == pytest.approx(column[:3], rel=1e-12)
        in_matrix = by_matrix(ca.DM(BETWEEN.reshape(6, 10)))[number].full()
        assert in_matrix.ravel() == pytest.approx(column, rel=1e-12)


def test_the_path_in_the_tables_is_exact(path):
    """Within 1e-9 rad, and its derivatives."""
    tables = tables_of(ur5_with_bar(), path)
    for order, table in enumerate(tables.path):
        wanted = path(BETWEEN, order)
        error = np.abs(_values(tables, table) - wanted).max()
        assert error <= 1e-9 * max(1.0, np.abs(wanted).max()) ** order


def test_an_array_that_is_written_again_is_another_place():
    plant = ur5_with_bar().along(straight())
    place, one = np.array([0.2]), np.ones(1)
    for there in (0.2, 0.7):
        place[0] = there
        angle = plant.joints(JointMotion(place, one, one))[0].angle
        assert angle == pytest.approx(START[0] + there * (END[0] - START[0]), abs=1e-9)


def test_tables_of_nothing_have_no_terms():
    """Without friction and rotors that rub: coefficients that are zeros are none, not noise."""
    tables = tables_of(ur5_with_bar(), straight())
    assert not tables.torques["e"].any()
    assert tables.torques["a"].shape[1] < 20


def test_a_plant_of_a_robot_keeps_the_contract(path):
    ur5_with_bar().along(path).validate()


def test_the_equilibrium_moves_with_the_path():
    """A slow motion stays in it: W = 0 solves the equations where speed and acceleration are 0."""
    plant = ur5_with_bar().along(straight())
    for place in (0.0, 0.4, 1.0):
        rest = plant.modal_accelerations(JointMotion(place, 0.0, 0.0), [0.0] * 2, [0.0] * 2)
        assert [float(w) for w in rest] == [0.0, 0.0]


def test_torques_at_rest_hold_the_robot_and_its_bar():
    """The shoulder's pan holds nothing, the lift what weighs on it, by the masses' leverage."""
    robot = ur5_with_bar()
    plant = robot.along(straight())
    still = [0.0] * 2
    torques = plant.torques(JointMotion(0.0, 0.0, 0.0), still, still, still)
    assert float(torques[0]) == pytest.approx(0.0, abs=1e-9)
    p = robot.dynamics.sag(START)
    rest = robot.dynamics.at_rest(np.concatenate([START, p]))[0][:6]
    assert [float(torque) for torque in torques] == pytest.approx(rest, rel=1e-9, abs=1e-7)


def test_frequency_of_the_table_is_that_of_the_robot():
    robot = ur5_with_bar()
    tables = tables_of(robot, straight())
    assert tables.frequencies == pytest.approx(robot.frequencies((START + END) / 2), rel=1e-9)


@pytest.mark.slow
def test_more_modes_and_a_base_that_rocks():
    """Its equations, too, are those of a plant: stable, passive, at rest with the path."""
    robot = dataclasses.replace(ur5_with_bar(), base=Base((2e4, 2e4), (5.0, 5.0), 0.5), modes=4)
    plant = robot.along(straight())
    plant.validate()
    assert plant.modes == 4
    assert plant.tips == 3
