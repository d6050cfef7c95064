"""The judge of a plant whose equations are a reduction: CVODES on the whole equations.

A robot's plans are made with a few modes and with tables of its path. Here every spring moves, by
the equations themselves, and neither modes nor tables are used.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache, partial
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models import JointMotion
from quietarm.models.compiled import Compiled
from quietarm.models.plant import SprungEquations
from quietarm.ocp.energy import Energy
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.profiles.free_motion import Law, PiecewiseMotion
from quietarm.ocp.sample import Sample
from quietarm.ocp.simulation.collocation import NODES
from quietarm.ocp.simulation.mesh import Mesh
from quietarm.ocp.simulation.objective import spent

Array = NDArray[np.float64]


Places = float | Array
"""On a path, or of all joints."""


class FullFigures(NamedTuple):
    """Energy [J], residual as a distance [m], and the peak torque of every joint [N m].

    On arrival: angles of the springs and their rates, shape (2 * springs,).
    """

    energy: float
    residual: float
    peak_torques: Array
    arrival: Array


def follow_in_full(
    equations: SprungEquations,
    motion: PiecewiseMotion,
    ends: tuple[Places, Places],
    steps: int,
    window: Array,
    energy: Energy,
) -> FullFigures:
    """Follow a motion by the whole equations.

    Parameters
    ----------
    equations : SprungEquations
        Of the plant.
    motion : PiecewiseMotion
        The move.
    ends : (float or ndarray, float or ndarray)
        Start and target, where the springs of the joints are at rest: places on a path, or rows of
        positions.
    steps : int
        Of the quadrature, on every piece.
    window : ndarray
        Times after arrival at which the tip is looked at [s], 0 the first.
    energy : Energy
        Energy.

    Raises
    ------
    SolverFailedError
        When CVODES cannot follow the motion.
    """
    mesh = Mesh(steps)
    start, target = ends
    rest = equations.at_rest(target)
    state = np.concatenate([equations.at_rest(start), np.zeros(equations.springs)])
    numbers = motion.arguments.shape[0]
    along = _compiled(_build_along, equations, motion.law, numbers, steps)
    outputs = _compiled(_build_torques_and_speeds, equations, motion.law, numbers, steps)
    work = 0.0
    peaks = list[Array]()
    try:
        for column in motion.arguments.T:
            (states,) = along(state, column)
            state = states[:, -1]
            torques, speeds = np.split(outputs(states, column, mesh.samples[None])[0], 2)
            peaks.append(np.abs(torques).max(axis=1))
            nodes = [
                _sample(torques[:, 1 + node : -1 : NODES], speeds[:, 1 + node : -1 : NODES])
                for node in range(NODES)
            ]
            lengths = ca.DM(column[-1] * mesh.lengths).T
            work += float(ca.sum1(spent(energy, nodes, lengths)))
        times = tuple(window.tolist())
        after = _compiled(_build_afterwards, equations, np.size(target), times)
        (later,) = after(state, np.atleast_1d(target))
    except RuntimeError as error:
        raise SolverFailedError(f"CVODES could not follow this motion{motion.remedy}") from error
    angles = np.column_stack([rest, later[: equations.springs]])
    tips = _compiled(_build_tips, equations, np.size(target), angles.shape[1])
    places = tips(np.atleast_1d(target), angles)[0].T
    away = np.linalg.norm(places[1:] - places[0], axis=1)
    return FullFigures(work, float(away.max()), np.max(peaks, axis=0), state)


@lru_cache(maxsize=16)  # four of a robot on its path, and of a few more
def _compiled(build: Callable[..., ca.Function], *parts: Any) -> Compiled:
    """Return the function that is built of its parts, all that it follows from."""
    name = build.__name__
    return Compiled(partial(build, *parts), silent=True, kept_as=(name, *parts))


def _build_along(equations: SprungEquations, law: Law, numbers: int, steps: int) -> ca.Function:
    """(state, arguments of the law) -> states at the samples of a piece, a column each."""
    given = ca.SX.sym("given", numbers)
    fraction = ca.SX.sym("fraction")
    motion = law(ca.vertsplit(given), fraction, jerk=False)
    return _followed(equations, motion, given, fraction, given[-1], Mesh(steps).samples)


def _build_afterwards(
    equations: SprungEquations, size: int, window: tuple[float, ...]
) -> ca.Function:
    """(state, place) -> states at times after arrival, with the joints at rest."""
    place = ca.SX.sym("there", size)
    fraction = ca.SX.sym("fraction")
    still = JointMotion(place, 0.0, 0.0)
    fractions = np.array(window) / window[-1]
    return _followed(equations, still, place, fraction, ca.SX(window[-1]), fractions)


def _followed(
    equations: SprungEquations,
    path: JointMotion,
    given: ca.SX,
    fraction: ca.SX,
    duration: ca.SX,
    fractions: Array,
) -> ca.Function:
    """(state, given) -> states at these fractions of a motion, a column each."""
    count = equations.springs
    state = ca.SX.sym("state", 2 * count)
    angles = state[:count]
    rates = state[count:]
    accelerations = equations.accelerations(path, angles, rates)
    problem = {
        "t": fraction,
        "x": state,
        "p": given,
        "ode": duration * ca.vertcat(rates, accelerations),
    }
    times = fractions[1:].tolist()
    run = ca.integrator("full", "cvodes", problem, 0.0, times, CVODES)
    before = ca.MX.sym("before", 2 * count)
    parameters = ca.MX.sym("given", given.numel())
    states = ca.horzcat(before, run(x0=before, p=parameters)["xf"])
    return ca.Function("states", [before, parameters], [states])


CVODES = {
    "linear_multistep_method": "bdf",  # hinges of a beam are damped within some steps
    "reltol": 1e-9,
    "abstol": 1e-11,
    "max_num_steps": 1_000_000,
}
"""Options: energies are then within 1e-7 of those by tolerances of a hundredth."""


def _build_torques_and_speeds(
    equations: SprungEquations, law: Law, numbers: int, steps: int
) -> ca.Function:
    """(states, arguments, fractions) -> torques and speeds of the joints, a column a sample."""
    given = ca.SX.sym("given", numbers)
    fraction = ca.SX.sym("fraction")
    path = law(ca.vertsplit(given), fraction, jerk=False)
    springs = equations.springs
    state = ca.SX.sym("state", 2 * springs)
    torques = equations.torques(path, state[:springs], state[springs:])
    speeds = ca.vertcat(*(joint.speed for joint in equations.joints(path)))
    outputs = [ca.densify(ca.vertcat(torques, speeds))]
    once = ca.Function("output", [state, given, fraction], outputs, {"cse": True})
    return once.map("outputs", "serial", len(Mesh(steps).samples), [1], [])


def _sample(torques: Array, speeds: Array) -> Sample:
    """The nodes of all steps, as far as the energy reads them."""
    still = JointMotion(ca.DM(0.0), ca.DM(0.0), ca.DM(0.0))
    joints = [JointMotion(0.0, ca.DM(row).T, 0.0) for row in speeds]
    return Sample(
        path=still,
        joints=joints,
        W=[],
        dW=[],
        ddW=[],
        tips=[],
        torques=[ca.DM(row).T for row in torques],
    )


def _build_tips(equations: SprungEquations, size: int, states: int) -> ca.Function:
    """(place, angles of the springs) -> the tip, a column a state, with the joints at rest."""
    place = ca.SX.sym("place", size)
    angles = ca.SX.sym("angles", equations.springs)
    origin = equations.tip(JointMotion(place, 0.0, 0.0), angles)
    once = ca.Function("tip", [place, angles], [ca.densify(origin)], {"cse": True})
    return once.map("tips", "serial", states, [0], [])


def times_after(window: float, fastest: float) -> Array:
    """Times after arrival [s] so near that they miss a ten-thousandth of a peak at most."""
    samples = math.ceil(window * fastest / _RADIANS_A_SAMPLE) + 1
    return np.linspace(0.0, window, samples)


_RADIANS_A_SAMPLE = 0.03
"""Phase of the fastest mode that is planned with between two of them."""
