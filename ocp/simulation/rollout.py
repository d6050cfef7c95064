"""The one simulation of a plant along a joint profile, as casadi expressions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models import Expression, JointMotion, Plant
from quietarm.models.joint_motion import is_zero
from quietarm.ocp.checks import takes
from quietarm.ocp.energy import ABSOLUTE_POWER, Energy
from quietarm.ocp.limits import Quantity, ask_for_jerk
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.sample import Sample, sample_plant
from quietarm.ocp.simulation.collocation import (
    GAUSS_WEIGHTS,
    NODES,
    NodeState,
    at_each_node,
    collocate,
    modal_system,
)
from quietarm.ocp.simulation.mesh import Mesh, mesh_of
from quietarm.ocp.simulation.objective import spent
from quietarm.ocp.uncertainty import perturb_plant

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SymbolicRollout:
    """A simulation as CasADi expressions: one row a candidate, one column a step.

    Every step has three Gauss nodes; what holds at the nodes is a list of three, each of shape
    (candidates, steps). All of it can be differentiated twice.

    Attributes
    ----------
    samples : list of Sample
        The plant at each Gauss node: joints, modes, tips and torques.
    arrival : Expression
        W (m) and then W' (m/s) at arrival, shape (candidates, 2 * modes).
    h : Expression
        Length of every step [s].
    unbroken, definition
        Whether no break lies between the steps; what counts as the energy.
    """

    samples: list[Sample]
    arrival: Expression
    h: Expression
    unbroken: bool
    definition: Energy

    @property
    def torque(self) -> list[Expression]:
        """Torque of the first joint at each Gauss node [N m]."""
        return [sample.torques[0] for sample in self.samples]

    @property
    def power(self) -> list[Expression]:
        """Mechanical power of all joints together at each Gauss node [W]."""
        return [sample.power for sample in self.samples]

    @property
    def weights(self) -> list[Expression]:
        """Quadrature weights of the nodes [s], so that sums of weight times value are integrals."""
        return [weight * self.h for weight in GAUSS_WEIGHTS]

    @property
    def energy(self) -> Expression:
        """Energy [J], one row a candidate."""
        return spent(self.definition, self.samples, self.h, self.unbroken)

    def values(self, quantity: Quantity) -> list[Expression]:
        """A quantity at the nodes, (candidates, steps) each: all nodes of its first value first."""
        by_value = zip(*map(quantity.values, self.samples))
        return [0 * self.h + x for at_nodes in by_value for x in at_nodes]


class Simulation(NamedTuple):
    """The common part of simulations of many candidates.

    Errors are what may differ from the plant in a candidate, as by `perturb_plant`; breaks are the
    fractions of the move at which the motion is not smooth.
    """

    plant: Plant
    profile: JointProfile
    steps: int
    quantities: tuple[Quantity, ...] = ()
    errors: tuple[str, ...] = ()
    energy: Energy = ABSOLUTE_POWER
    breaks: tuple[float, ...] = ()

    @property
    def mesh(self) -> Mesh:
        """The mesh: where the steps begin and end."""
        return mesh_of(self.profile, self.steps, self.breaks)

    def kept_as(self, what: str) -> tuple[str, Simulation] | None:
        """Return what a function of it follows from, if such are left to the next process."""
        return (what, self) if self.plant.is_kept else None

    def rollout(
        self,
        coefficients: Expression | Sequence[Expression],
        row: Sequence[Expression],
        errors: Sequence[Expression],
        candidates: int = 1,
    ) -> SymbolicRollout:
        """Simulate in symbols, for the `row` of a task and relative errors of its plant."""
        return symbolic_rollout(
            perturb_plant(self.plant, dict(zip(self.errors, errors))),
            self.profile,
            coefficients,
            move=row[:3],
            steps=self.steps,
            candidates=candidates,
            jerk=ask_for_jerk(self.quantities),
            breaks=self.breaks,
            initial=row[3:],
            energy=self.energy,
        )

    def arrivals(self, coefficients: Sequence[float], row: Sequence[float], errors: Array) -> Array:
        """Return the state on arrival of one motion for each row of relative errors.

        It is that of `rollout` in numbers, without torques: nothing is built or compiled, which
        takes longer than a few rows.

        Parameters
        ----------
        coefficients : sequence of float
            Of the profile.
        row : sequence of float
            That of a task: start, target, duration, and the state before.
        errors : ndarray, shape (rows, errors)

        Returns
        -------
        ndarray, shape (rows, 2 * modes)
        """
        rows = len(errors)
        nodes = NODES * len(self.mesh.lengths)

        def columns(values: Sequence[float]) -> list[ca.DM]:
            return [ca.DM(np.full((rows, nodes), value)) for value in values]

        by_node = [ca.DM(np.repeat(column[:, None], nodes, axis=1)) for column in errors.T]
        at_nodes = [*columns(row[:3]), *row[3:]]
        return np.array(self.arrival(columns(coefficients), at_nodes, by_node, rows))

    def arrival(
        self,
        coefficients: Sequence[Expression],
        row: Sequence[Expression],
        errors: Sequence[Expression],
        candidates: int,
    ) -> Expression:
        """The state on arrival alone of `rollout`, without torques: of symbols or of numbers."""
        plant = perturb_plant(self.plant, dict(zip(self.errors, errors)))
        joint, h = _at_nodes(self.profile, coefficients, row[:3], self.mesh, candidates)
        every_step = collocate(modal_system(plant, joint), h)
        *_, arrival = march(*every_step.transition(), h.shape, row[3:])
        return arrival


@lru_cache(maxsize=128)
def places_of(simulation: Simulation) -> Mapping[str, slice]:
    """Places of the values of each quantity among all of a candidate."""
    places: dict[str, slice] = {}
    first = 0
    for quantity in simulation.quantities:
        count = quantity.rows(simulation.plant) * NODES * len(simulation.mesh.lengths)
        places[quantity.name] = slice(first, first + count)
        first += count
    return places


@takes(plant=Plant, profile=JointProfile, energy=Energy)
def symbolic_rollout(
    plant: Plant,
    profile: JointProfile,
    coefficients: Expression | Sequence[Expression],
    move: Sequence[Expression],
    steps: int,
    candidates: int = 1,
    jerk: bool = False,
    breaks: tuple[float, ...] = (),
    initial: Sequence[Expression] = (),
    energy: Energy = ABSOLUTE_POWER,
) -> SymbolicRollout:
    """Simulate the modes along the profile in fixed steps: joint, modes, torque, state on arrival.

    Parameters
    ----------
    coefficients : Expression or sequence of Expression
        The profile's coefficients: a column (SX, MX or DM) of the decision variables, or one
        expression each, a scalar or of shape (candidates, 3 * steps).
    move : sequence of Expression
        start [rad], target [rad], duration [s]; of such shapes.
    steps, candidates : int
        Number of steps, and of rows.
    jerk : bool
        Whether the joint's jerk is computed as well, at the times of `Mesh.stretch`.
    breaks : tuple of float
        Fractions of the duration at which the motion is not smooth: there a step ends.
    initial : sequence of Expression
        W [m], then W' [m/s] at the start, each of shape (candidates, 1) or a scalar; at rest by
        default.
    energy : Energy
        What counts as the energy.

    Raises
    ------
    ValueError
        When the coefficients are not as many as the profile has.
    """
    if isinstance(coefficients, ca.SX | ca.MX | ca.DM):
        coefficients = ca.vertsplit(coefficients)
    if len(coefficients) != profile.size:
        raise ValueError(
            f"got {len(coefficients)} coefficients for a profile of {profile.size}; give one each"
        )
    mesh = mesh_of(profile, steps, breaks)
    joint, h = _at_nodes(profile, coefficients, move, mesh, candidates)
    if jerk:
        fraction = ca.horzcat(*mesh.columns(candidates)[0])
        stretched = profile.motion(coefficients, mesh.stretch(fraction), *move, jerk=True)
        joint = joint._replace(jerk=stretched.jerk)
    every_step = collocate(modal_system(plant, joint), h)
    W, dW, arrival = march(*every_step.transition(), h.shape, initial)
    states = every_step.nodes(W, dW, every_step.accelerations(W, dW))
    everywhere = sample_plant(plant, joint, *modes_at_nodes(states))
    by_node = zip(*(at_each_node(value, h) for value in everywhere.values))
    return SymbolicRollout(
        samples=[everywhere.with_values(values) for values in by_node],
        arrival=arrival,
        h=h,
        unbroken=not breaks,
        definition=energy,
    )


def _at_nodes(
    profile: JointProfile,
    coefficients: Sequence[Expression],
    move: Sequence[Expression],
    mesh: Mesh,
    candidates: int,
) -> tuple[JointMotion, Expression]:
    """The joint at the nodes of all steps, those of a kind side by side, and the steps' lengths."""
    times, length = mesh.columns(candidates)
    joint = profile.motion(coefficients, ca.horzcat(*times), *move)
    return joint, at_each_node(move[2], length)[0] * length


def modes_at_nodes(states: Sequence[NodeState]) -> NodeState:
    """The modes at all nodes of the steps: the first nodes', then the second ones' beside these."""
    parts = zip(*states)
    return NodeState(*([ca.horzcat(*x) for x in zip(*part)] for part in parts))


def march(
    constant: Sequence[Expression],
    columns: Sequence[Sequence[Expression]],
    shape: tuple[int, int],
    initial: Sequence[Expression] = (),
    width: int = 1,
) -> tuple[list[Expression], list[Expression], Expression]:
    """States before every step (rows, steps), by mode, and the state at arrival; from rest or else.

    Only this recursion is sequential: everything else is computed for all steps at once. With a
    `width` above 1 a row has as many states side by side, and the constant as many columns a step.
    """
    rows, steps = shape
    size = len(constant)
    acting = tuple((i, k) for k in range(size) for i in range(size) if not is_zero(columns[k][i]))
    by_step = [ca.horzsplit(ca.DM.zeros(rows, steps * width) + x, width) for x in constant]
    by_step += [ca.horzsplit(ca.DM.zeros(rows, steps) + columns[k][i], 1) for i, k in acting]
    affine = _affine_step(rows, width, size, acting)
    states = [[ca.DM.zeros(rows, width) + x for x in initial or [0.0] * size]]
    for at_step in zip(*by_step):
        states.append(affine.call([*states[-1], *at_step], True, False))  # inline
    *before, arrival = states
    by_mode = [ca.horzcat(*state) for state in zip(*before)]
    return by_mode[: size // 2], by_mode[size // 2 :], ca.horzcat(*arrival)


@lru_cache(maxsize=32)
def _affine_step(
    rows: int, width: int, size: int, acting: tuple[tuple[int, int], ...]
) -> ca.Function:
    """(states, constants, entries of the matrix that are not zero) -> states after."""
    before, constants = ([ca.MX.sym("x", rows, width) for _ in range(size)] for _ in range(2))
    gains = [ca.MX.sym("a", rows) for _ in acting]
    after = [*constants]
    for (i, k), gain in zip(acting, gains):
        after[i] = after[i] + ca.repmat(gain, 1, width) * before[k]
    return ca.Function("step", [*before, *constants, *gains], after)
