"""The response of a plant's signals to its joint, by some of its parameters.

With the joint at rest they are exponentials of the plant's eigenvalues. Where the joint moves they
are followed through the recording by the collocation of the plans: the modes are affine in their
state at the start. All have exact derivatives by the plant's parameters.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models import JointMotion, Plant
from quietarm.models.compiled import Compiled
from quietarm.models.joint_motion import Modes
from quietarm.ocp.simulation.collocation import NODES, modal_system, step
from quietarm.ocp.uncertainty import with_values

Array = NDArray[np.float64]


class Response:
    """The response of a plant's signals to its joint, by some of its parameters.

    Parameters
    ----------
    plant : Plant
        Its equations.
    names : sequence of str
        The parameters.
    kinds : sequence of str
        ``"tip"``, ``"acceleration"`` or ``"torque"``, of each signal.
    """

    def __init__(self, plant: Plant, names: Sequence[str], kinds: Sequence[str]) -> None:
        self.plant = plant
        self.names = list(names)
        self.kinds = np.array(kinds)
        p = ca.SX.sym("p", len(names))
        by_name = dict(zip(names, ca.vertsplit(p)))
        changed = with_values(plant, by_name)
        self._at_rest = self._state_matrix(changed, p)
        self._step = self._one_step(changed, p)
        self._linear = self._linear_system(changed, p)
        self.march = lru_cache(maxsize=8)(self._march)

    @property
    def is_linear(self) -> bool:
        """Return whether signals answer the joint's acceleration alone, the same at every angle."""
        return self._linear is not None

    def _state_matrix(self, plant: Plant, p: ca.SX) -> Compiled:
        """Build the modes' state matrix with the joint at rest, and its derivatives by p."""
        modes = plant.modes
        angle = ca.SX.sym("angle")
        system = modal_system(plant, JointMotion(angle, 0.0, 0.0))
        K, D = (ca.vertcat(*(ca.horzcat(*row) for row in M)) for M in (system.K, system.D))
        A = ca.blockcat([[ca.SX(modes, modes), ca.SX.eye(modes)], [-K, -D]])
        by_p = ca.jacobian(ca.vec(A), p)
        function = ca.Function("A", [p, angle], [ca.densify(A), ca.densify(by_p)])
        return Compiled(lambda: function)

    def _one_step(self, plant: Plant, p: ca.SX) -> ca.Function:
        """Columns of the state a step later, and what is recorded of them before it.

        The step is its length, and angle, speed and acceleration at each node and at its begin.
        """
        size = 2 * plant.modes
        joint = ca.SX.sym("joint", 4 + 3 * NODES)
        X = ca.SX.sym("X", size, 1 + size)
        motions = [JointMotion(*ca.vertsplit(joint[k : k + 3])) for k in range(1, 4 + 3 * NODES, 3)]
        constant, by_state = step(plant, motions[:NODES], joint[0]).transition()
        transition = ca.horzcat(*(ca.vertcat(*column) for column in by_state))
        after = transition @ X
        after[:, 0] += ca.vertcat(*constant)
        seen = self._seen(plant, motions[-1], X)
        return ca.Function("step", [X, joint, p], [after, ca.vec(seen)], {"cse": True})

    def _linear_system(self, plant: Plant, p: ca.SX) -> Compiled | None:
        """A, B, C, D by p: the state answers an acceleration, and the signals both.

        None where the angle or a constant matters, or where it is not linear.
        """
        if "torque" in self.kinds:
            return None
        angle = ca.SX.sym("angle")
        acceleration = ca.SX.sym("ddq")
        X = ca.SX.sym("X", 2 * plant.modes)
        W, dW = (ca.vertsplit(half) for half in ca.vertsplit(X, plant.modes))
        joint = JointMotion(angle, ca.SX(0.0), acceleration)
        ddW = [ca.SX(entry) for entry in plant.modal_accelerations(joint, W, dW)]
        rates = ca.vertcat(*dW, *ddW)
        seen = self._signals(plant, joint, W, dW, ddW)
        outputs = ca.vertcat(rates, seen)
        inputs = ca.vertcat(X, acceleration)
        slopes = ca.jacobian(outputs, inputs)
        constant = ca.substitute(outputs, inputs, ca.SX.zeros(inputs.numel()))
        no_constant = ca.simplify(constant).is_zero() if constant.nnz() else True
        if not no_constant or ca.depends_on(slopes, ca.vertcat(inputs, angle)):
            return None
        function = ca.Function("linear", [p], [ca.densify(slopes)])
        return Compiled(lambda: function)

    def modal_form(self, p: Array) -> tuple[Array, Array, Array]:
        """Eigenvalues above the real axis or on it, slowest first; residues; what is fed through.

        The signals are the real part of residues (signals, eigenvalues) times what each eigenvalue
        makes of the joint's acceleration, and that times the feed (signals,).
        """
        assert self._linear is not None
        (slopes,) = self._linear(p)
        size = 2 * self.plant.modes
        A = slopes[:size, :size]
        C = slopes[size:, :size]
        values: Any
        values, right = np.linalg.eig(A.astype(complex))
        residues = (C @ right) * np.linalg.solve(right, slopes[:size, size])
        order = [k for k in np.argsort(values.imag) if values[k].imag >= 0]
        twice = np.where(values[order].imag > 0, 2.0, 1.0)
        return values[order], residues[:, order] * twice, slopes[size:, size]

    def _seen(self, plant: Plant, joint: JointMotion, X: ca.SX) -> ca.SX:
        """Return the recorded signals, a row each, of columns of the state."""
        W, dW = (ca.vertsplit(half) for half in ca.vertsplit(X[:, 0], plant.modes))
        ddW = plant.modal_accelerations(joint, W, dW)
        seen = self._signals(plant, joint, W, dW, ddW)
        return ca.horzcat(seen, ca.jacobian(seen, X[:, 0]) @ X[:, 1:])

    def _signals(self, plant: Plant, joint: JointMotion, W: Modes, dW: Modes, ddW: Modes) -> ca.SX:
        """Return the recorded signals, a row each, of modal amplitudes and their rates."""
        by_kind = {
            "tip": iter(plant.tips_at(joint, W)),
            "acceleration": iter(plant.tips_at(joint, ddW)),
            "torque": iter([plant.torque(joint, W, dW, ddW)]),
        }
        return ca.vertcat(*(next(by_kind[kind]) for kind in self.kinds))

    def eigenvalues(self, p: Array, angle: float = 0.0) -> tuple[Any, Any]:
        """Return the eigenvalues that swing with the joint at rest, and their derivatives by p.

        The slowest comes first.
        """
        A, by_p = self._at_rest(p, angle)
        values: Any
        values, right = np.linalg.eig(A)
        transposed = by_p.T.reshape(-1, *A.shape)
        slopes = np.einsum("kl,jil,ik->kj", np.linalg.inv(right), transposed, right)
        order = [k for k in np.argsort(values.imag) if values[k].imag > 0]
        return values[order], slopes[order]

    def _march(self, count: int, derivatives: bool) -> Compiled:
        """Columns of so many steps, and their derivatives by p."""
        return Compiled(lambda: self._build_march(count, derivatives))

    def _build_march(self, count: int, derivatives: bool) -> ca.Function:
        p = ca.MX.sym("p", len(self.names))
        joint = ca.MX.sym("joint", 4 + 3 * NODES, count)
        size = 2 * self.plant.modes
        start = np.eye(size, 1 + size, 1)
        rows = self._step.mapaccum(count)(start, joint, ca.repmat(p, 1, count))[1]
        by_p = [ca.jtimes(rows, p, ca.DM.eye(len(self.names)))] if derivatives else []
        return ca.Function("march", [joint, p], [ca.densify(rows), *map(ca.densify, by_p)])


@lru_cache(maxsize=64)
def response_of(plant: Plant, names: tuple[str, ...], kinds: tuple[str, ...]) -> Response:
    """The response of a plant, built once for all recordings with the same signals."""
    return Response(plant, names, kinds)
