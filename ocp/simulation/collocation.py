"""One step of the plant's modes along a given joint motion, by Gauss collocation.

The modes obey W'' = g - D W' - K W with coefficients that vary in time. With W'' a polynomial
through the three Gauss nodes of a step, the state after it is an affine map of the state before,
exact to order six. Source: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I,
section II.7 (Gauss methods), in Nystrom form.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from quietarm.models import Expression, JointMotion, Plant
from quietarm.models.joint_motion import Modes, is_zero

NODES = 3


# Plain floats: a numpy number on the left of a casadi symbol would try to make an array of it.
_points, _weights = np.polynomial.legendre.leggauss(NODES)
_nodes = (_points[:, None] + 1) / 2
_powers = np.arange(NODES)
_to_quadratic = np.linalg.inv(_nodes**_powers)
_once = np.vstack([_nodes ** (_powers + 1) / (_powers + 1) @ _to_quadratic, _weights / 2])
GAUSS_NODES: list[float] = _nodes.ravel().tolist()
"""Where the nodes are on a step from 0 to 1."""
GAUSS_WEIGHTS: list[float] = _once[NODES].tolist()
"""What values at the nodes count for in the integral over the step."""
TO_QUADRATIC: list[list[float]] = _to_quadratic.tolist()
"""From values at the nodes to the coefficients of the quadratic through them, lowest first."""
_ONCE: list[list[float]] = _once.tolist()
_TWICE: list[list[float]] = (_once @ _once[:NODES]).tolist()
"""Its single and double integrals up to each node, and in the last row up to the end."""


class ModalSystem(NamedTuple):
    """W'' = g - D W' - K W at one time: g [m/s^2] by mode, K [1/s^2] and D [1/s] by two modes."""

    g: list[Expression]
    K: list[list[Expression]]
    D: list[list[Expression]]


def modal_system(plant: Plant, joint: JointMotion) -> ModalSystem:
    """The modes' coefficients along a joint motion, by the plant's equations at unit vectors."""
    modes = range(plant.modes)
    zero = [0.0] * plant.modes
    acts = _acting(plant, joint)
    units = [[float(entry == mode) for entry in modes] for mode in modes]
    g = list(plant.modal_accelerations(joint, zero, zero))

    def columns(responses: Sequence[Modes]) -> list[list[Expression]]:
        return [[g[i] - responses[j][i] if acts[i][j] else 0.0 for j in modes] for i in modes]

    return ModalSystem(
        g,
        K=columns([plant.modal_accelerations(joint, unit, zero) for unit in units]),
        D=columns([plant.modal_accelerations(joint, zero, unit) for unit in units]),
    )


def _acting(plant: Plant, joint: JointMotion) -> list[list[bool]]:
    """Return whether mode j acts on mode i at all; where it does not, no term is computed."""
    modes = range(plant.modes)
    kind = _kind_of(plant)
    if isinstance(joint.angle, ca.DM):  # numbers tell by themselves
        return [[True for _ in modes] for _ in modes]
    joint = JointMotion(*(kind.sym("joint") for _ in range(3)))
    W, dW = ([kind.sym("W") for _ in modes] for _ in range(2))
    after = [kind(entry) for entry in plant.modal_accelerations(joint, W, dW)]
    return [[ca.depends_on(after[i], ca.vertcat(W[j], dW[j])) for j in modes] for i in modes]


def _kind_of(plant: Plant) -> Any:
    """SX where a parameter of the plant, or of one inside it, is such a symbol, else MX."""
    values = list(vars(plant).values())
    inside = (value for value in values if isinstance(value, Plant))
    is_sx = any(isinstance(value, ca.SX) for value in values)
    return ca.SX if is_sx or any(_kind_of(value) is ca.SX for value in inside) else ca.MX


class NodeState(NamedTuple):
    """The modes at one node of a step: amplitudes [m], rates [m/s], accelerations [m/s^2]."""

    W: list[Expression]
    dW: list[Expression]
    ddW: list[Expression]


@dataclass(frozen=True)
class Step:
    """One step of length `h` [s] as an affine map of the state (W, W') before it.

    Row j * modes + i of `response` is W'' of node j and mode i as [constant, by W..., by W'...];
    that of `forced`, where it was asked for, W'' by an excitation of 1 in each of these rows.
    """

    h: Expression
    response: list[list[Expression]]
    modes: int
    forced: Sequence[Sequence[Expression]] = ()

    def driven_by(self, forcing: Sequence[Expression]) -> Step:
        """The step with another excitation of each node and mode, in the order of `response`."""
        rows = zip(self.forced, self.response)
        return replace(self, response=[[dot(gains, forcing), *row[1:]] for gains, row in rows])

    def accelerations(self, W: Modes, dW: Modes) -> list[list[Expression]]:
        """W'' at the nodes for the state before the step: a list over nodes of lists over modes."""
        return self._by_node(row[0] + dot(row[1:], [*W, *dW]) for row in self.response)

    def _by_node(self, rows: Iterable[Expression]) -> list[list[Expression]]:
        flat = list(rows)
        return [flat[j * self.modes : (j + 1) * self.modes] for j in range(NODES)]

    def end(self, W: Modes, dW: Modes, ddW: Sequence[Modes]) -> tuple[Modes, Modes]:
        """State after the step, from the state before it and W'' at its nodes."""
        times = [self.h, self.h * self.h]
        by_mode = list(zip(*ddW))
        once = [dot(_ONCE[NODES], at_nodes) for at_nodes in by_mode]
        twice = [dot(_TWICE[NODES], at_nodes) for at_nodes in by_mode]
        return (
            [w + dot(times, (v, change)) for w, v, change in zip(W, dW, twice)],
            [v + dot(times[:1], (change,)) for v, change in zip(dW, once)],
        )

    def transition(self) -> tuple[list[Expression], list[list[Expression]]]:
        """(constant, columns): the state after is constant + columns times the state before."""
        return self.column(0), [self.column(1 + row) for row in range(2 * self.modes)]

    def column(self, number: int) -> list[Expression]:
        """One column of that map, the constant first."""
        state = [float(number == 1 + row) for row in range(2 * self.modes)]
        ddW = self._by_node(row[number] for row in self.response)
        W, dW = self.end(state[: self.modes], state[self.modes :], ddW)
        return [*W, *dW]

    def nodes(self, W: Modes, dW: Modes, ddW: Sequence[Modes]) -> list[NodeState]:
        """The modes at the nodes, from the state before the step and W'' at its nodes."""
        h = self.h
        square = self.h * self.h
        by_mode = list(zip(*ddW))
        nodes = list[NodeState]()
        for c, once, twice, accelerations in zip(GAUSS_NODES, _ONCE, _TWICE, ddW):
            amplitudes = [
                w + c * h * v + square * dot(twice, at_nodes)
                for w, v, at_nodes in zip(W, dW, by_mode)
            ]
            rates = [v + h * dot(once, at_nodes) for v, at_nodes in zip(dW, by_mode)]
            nodes.append(NodeState(amplitudes, rates, list(accelerations)))
        return nodes


def step(plant: Plant, joints: Sequence[JointMotion], h: Expression) -> Step:
    """One step of length h [s] from the joint at its nodes."""
    fields = zip(*(joint[:3] for joint in joints))
    joint = JointMotion(*(ca.horzcat(*(0 * h + x for x in field)) for field in fields))
    return collocate(modal_system(plant, joint), h)


def collocate(system: ModalSystem, h: Expression, forced: bool = False) -> Step:
    """One step of length h [s] from the modes at its nodes; if forced, it can be `driven_by`.

    All that holds at the first nodes stands in the first columns, then that at the second ones.
    """
    modes = range(len(system.g))
    count = NODES * len(modes)
    g = [at_each_node(x, h) for x in system.g]
    K, D = ([[at_each_node(x, h) for x in row] for row in part] for part in system[1:])
    matrix: list[list[Expression]] = []
    right: list[list[Expression]] = []
    for j in range(NODES):
        for i in modes:
            place = len(matrix)
            terms = [(k[j], d[j]) for k, d in zip(K[i], D[i])]
            weights = zip(_ONCE[j], _TWICE[j])
            implicit = [_held(h, k, d, once, twice) for once, twice in weights for k, d in terms]
            matrix.append([float(place == at) + entry for at, entry in enumerate(implicit)])
            by_rate = [_negative(d, GAUSS_NODES[j] * h, k) for k, d in terms]
            unit = [float(place == at) for at in range(count)] if forced else []
            right.append([g[i][j], *(-k for k, _ in terms), *by_rate, *unit])
    rows = eliminate(matrix, right)
    size = 1 + 2 * len(modes)
    return Step(
        h,
        [row[:size] for row in rows],
        len(modes),
        [row[size:] for row in rows],
    )


def at_each_node(entry: Expression, h: Expression) -> list[Expression]:
    """Split values that stand side by side for the three nodes of steps of length h."""
    if is_zero(entry):
        return [entry] * NODES
    return ca.horzsplit(ca.DM.zeros(h.shape[0], NODES * h.shape[1]) + entry, h.shape[1])


def _held(h: Expression, k: Expression, d: Expression, once: float, twice: float) -> Expression:
    """Return the share of W'' at a node in the spring and damper forces at another."""
    return 0.0 if is_zero(k) else h * (once * d + twice * h * k)


def _negative(d: Expression, time: Expression, k: Expression) -> Expression:
    return 0.0 if is_zero(k) else -d - time * k


def dot(factors: Sequence[Expression], entries: Sequence[Expression]) -> Expression:
    """The sum of products, without those that are nothing."""
    pairs = zip(factors, entries)
    terms = [a * b for a, b in pairs if not (is_zero(a) or is_zero(b))]
    return sum(terms[1:], terms[0]) if terms else 0.0


def eliminate(
    matrix: list[list[Expression]], right: list[list[Expression]]
) -> list[list[Expression]]:
    """Solve `matrix` x = `right`, element by element, without pivoting.

    The matrix is the identity and what `default_steps` keeps small.
    """
    size = len(matrix)
    for i in range(size):
        for k in range(i + 1, size):
            if not is_zero(matrix[k][i]):
                factor = matrix[k][i] / matrix[i][i]
                matrix[k] = _less(matrix[k], factor, matrix[i])
                right[k] = _less(right[k], factor, right[i])
    for i in reversed(range(size)):
        for k in range(i + 1, size):
            if not is_zero(matrix[i][k]):
                right[i] = _less(right[i], matrix[i][k], right[k])
        right[i] = [a if is_zero(a) else a / matrix[i][i] for a in right[i]]
    return right


def _less(
    row: list[Expression], factor: Expression, subtracted: list[Expression]
) -> list[Expression]:
    """The row less a multiple of another; entries that are nothing cost nothing."""
    return [a if is_zero(b) else a - factor * b for a, b in zip(row, subtracted)]
