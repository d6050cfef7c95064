"""The independent integrator: CVODES along any joint motion.

It starts anew at every smooth piece, and gives the modes at the nodes of a fine quadrature. It is
built once for a plant and a kind of piece: what differs between moves is a parameter, and time is
the fraction of the piece.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import lru_cache, partial
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models import Plant
from quietarm.models.compiled import RECENT, Compiled
from quietarm.ocp.cost import COST
from quietarm.ocp.energy import Energy
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.profiles.free_motion import Law, PiecewiseMotion
from quietarm.ocp.sample import symbolic_sample
from quietarm.ocp.simulation.collocation import NODES
from quietarm.ocp.simulation.mesh import Mesh
from quietarm.ocp.simulation.objective import integrated, spent
from quietarm.ocp.simulation.trajectory import outputs_of, rates_of
from quietarm.ocp.uncertainty import perturb_plant

CVODES: dict[str, Any] = {
    "linear_multistep_method": "adams",  # order up to 12: a fifth of the steps of BDF's 5
    "reltol": 1e-11,
    "abstol": 1e-13,
}
"""Options of every run, but for its steps: see `_options`."""

Array = NDArray[np.float64]


class Integration(NamedTuple):
    """`outputs_of` every piece at its ends and nodes, a column each; state on arrival; work [J]."""

    outputs: Array
    arrival: Array
    energy: float
    net_work: float


def integrate(
    plant: Plant,
    errors: Mapping[str, float],
    path: PiecewiseMotion,
    initial: Sequence[float],
    steps: int,
    energy: Energy,
    smallness: float = 1.0,
) -> Integration:
    """Follow a motion on a plant with errors, by so many steps of the quadrature on a piece.

    Absolute tolerances are multiplied by the smallness, to the next power of ten.
    """
    with COST.timed("checks"), _refusing(path.remedy):
        figures = _figures(
            plant,
            path.law,
            path.arguments.shape,
            steps,
            tuple(errors),
            energy,
            math.floor(math.log10(smallness)),
        )
        outputs, arrival, spent, net_work = figures(path.arguments, list(errors.values()), initial)
    return Integration(outputs, arrival[:, 0], spent.item(), net_work.item())


def integrate_to(
    plant: Plant,
    errors: Mapping[str, float],
    path: PiecewiseMotion,
    initial: Sequence[float],
    fractions: Array,
) -> Array:
    """`outputs_of` at these fractions of a motion in one piece, 0 the first of them."""
    with _refusing(path.remedy):
        shape = path.arguments.shape
        names = tuple(errors)
        along = Compiled(lambda: _along(plant, path.law, shape, fractions, names), silent=True)
        return along(path.arguments, list(errors.values()), initial)[1]


@contextmanager
def _refusing(motion: str) -> Iterator[None]:
    """Let CVODES be called in this block; name the motion that it cannot follow."""
    try:
        yield
    except RuntimeError as error:
        raise SolverFailedError(f"CVODES could not follow this motion{motion}") from error


@lru_cache(maxsize=RECENT)
def _figures(
    plant: Plant,
    law: Law,
    shape: tuple[int, int],
    steps: int,
    names: tuple[str, ...],
    definition: Energy,
    decades: int,
) -> Compiled:
    """(arguments, errors, state before) -> outputs at nodes and ends, arrival, energy, net work."""
    parts = (plant, law, shape, steps, names, definition, decades)
    return Compiled(
        partial(_build_figures, *parts),
        silent=True,  # the error of `_refusing` is enough
        kept_as=("figures", *parts) if plant.is_kept else None,
    )


def _build_figures(
    plant: Plant,
    law: Law,
    shape: tuple[int, int],
    steps: int,
    names: tuple[str, ...],
    definition: Energy,
    decades: int,
) -> ca.Function:
    arguments = ca.MX.sym("p", *shape)
    mesh = Mesh(steps)
    errors = ca.MX.sym("e", len(names))
    initial = ca.MX.sym("x", 2 * plant.modes)
    states, outputs = _along(plant, law, shape, mesh.samples, names, decades)(
        arguments, errors, initial
    )
    pieces = [ca.reshape(row, -1, shape[1]) for row in ca.vertsplit(outputs)]
    layout = symbolic_sample(plant)
    nodes = [
        layout.with_values(row[1 + node : -1 : NODES, :].T for row in pieces)
        for node in range(NODES)
    ]
    h = arguments[-1, :].T @ mesh.columns()[1]
    energy = spent(definition, nodes, h)
    net_work = integrated([sample.power for sample in nodes], h)
    figures = [outputs, states[:, -1], ca.sum1(energy), ca.sum1(net_work)]
    dense = [ca.densify(figure) for figure in figures]  # a plant's output may be zero throughout
    return ca.Function("figures", [arguments, errors, initial], dense)


def _along(
    plant: Plant,
    law: Law,
    shape: tuple[int, int],
    fractions: Array,
    names: tuple[str, ...],
    decades: int = 0,
) -> ca.Function:
    """(arguments, errors, state before) -> states and outputs at these fractions of every piece."""
    numbers, pieces = shape
    count = len(fractions)
    arguments = ca.MX.sym("p", numbers, pieces)
    errors = ca.MX.sym("e", len(names))
    initial = ca.MX.sym("x", 2 * plant.modes)
    piece = _over_a_piece(plant, law, numbers, fractions, names, decades)
    _, states = piece.mapaccum(pieces)(initial, ca.vertcat(arguments, ca.repmat(errors, 1, pieces)))
    at_samples = [
        row if pieces == 1 else ca.vec(ca.repmat(row, count, 1)).T
        for row in ca.vertsplit(arguments)
    ]
    joint = law(at_samples, ca.DM(np.tile(fractions, pieces)).T, jerk=True)
    outputs = outputs_of(_perturbed(plant, names, errors), joint, states)
    return ca.Function(
        "along",
        [arguments, errors, initial],
        [states, ca.densify(outputs)],
    )


def _over_a_piece(
    plant: Plant,
    law: Law,
    numbers: int,
    fractions: Array,
    names: tuple[str, ...],
    decades: int,
) -> ca.Function:
    """CVODES: (state before, arguments and errors) -> state after a piece, states along it."""
    count = numbers + len(names)
    state = ca.SX.sym("x", 2 * plant.modes)
    fraction = ca.SX.sym("t")
    both = ca.SX.sym("p", count)
    arguments = ca.vertsplit(both[:numbers])
    perturbed = _perturbed(plant, names, both[numbers:])
    rates = arguments[-1] * rates_of(
        perturbed,
        law(arguments, fraction, jerk=False),
        state,
    )
    problem = {"t": fraction, "x": state, "p": both, "ode": rates}
    times = fractions[1:]
    run = ca.integrator(
        "piece",
        "cvodes",
        problem,
        0.0,
        times.tolist(),
        {**_options(times), "abstol": CVODES["abstol"] * 10.0**decades},
    )
    before = ca.MX.sym("x", state.numel())
    both = ca.MX.sym("p", count)
    states = ca.horzcat(before, run(x0=before, p=both)["xf"])
    return ca.Function("over", [before, both], [states[:, -1], states])


def _perturbed(plant: Plant, names: tuple[str, ...], errors: ca.SX | ca.MX) -> Plant:
    return perturb_plant(plant, dict(zip(names, ca.vertsplit(errors))))


def _options(times: Array) -> dict[str, str | float | int]:
    """Options of a run of some seconds at most; steps are counted from sample to sample."""
    gaps = np.diff(times, prepend=0.0)
    share = float(gaps.max() / gaps.sum())
    # Steps in a run: it takes some seconds, in which CVODES hears no signal. Coefficients of
    # 1000, five hundred times those of any plan, take 700 from one of 3500 samples to the next.
    most_steps = 3_000_000
    least_a_sample = 1_000
    return {**CVODES, "max_num_steps": max(least_a_sample, round(most_steps * share))}
