"""The condensed motion beside the plain rollout of the same case."""

import casadi as ca
import numpy as np

from ocp.program.condensed import Condensed, Inputs
from ocp.simulation.rollout import symbolic_rollout
from ocp.task.quantities import QUANTITIES as TABLE

TERMS = 3
MOVE = np.array([-0.4, 1.1, 0.7])
COEFFICIENTS = np.array([0.1, -0.2, 0.15])
QUANTITIES = {
    "none": (),
    "one": ("torque",),
    "two": ("deflection", "speed"),
    "all": tuple(TABLE),
}


def _plain(plant, profile, steps, quantities, second):
    """Arrival, outputs at the nodes in time, and their derivatives, from the plain rollout."""
    a, move, modes = ca.SX.sym("a", profile.size), ca.SX.sym("move", 3), plant.modes
    scale = ca.SX.sym("scale", 2 * modes + 1 + len(quantities))
    plain = symbolic_rollout(plant, profile, ca.vertsplit(a), ca.vertsplit(move), steps, jerk=True)
    tips = [plant.tip_displacements(node.W) for node in plain.states]
    at_nodes = {
        "power": [plain.power],
        "torque": [plain.torque],
        "speed": [[joint.speed for joint in plain.joints]],
        "acceleration": [[joint.acceleration for joint in plain.joints]],
        "jerk": [[joint.jerk for joint in plain.joints]],
        "deflection": [[tip[i] for tip in tips] for i in range(plant.tips)],
    }
    rows = [
        ca.vec(ca.vertcat(*row)).T / scale[2 * modes + i]
        for i, name in enumerate(("power", *quantities))
        for row in at_nodes[name]
    ]
    arrival, outputs = plain.arrival.T / scale[: 2 * modes], ca.vertcat(*rows)
    inputs, everything = [a, move, scale], ca.vertcat(arrival, ca.vec(outputs))
    multipliers = ca.SX.sym("lam", everything.numel())
    values = ca.Function("plain", inputs, [arrival, outputs, ca.jacobian(everything, a)])
    if not second:
        return values, None
    curvature = ca.hessian(ca.dot(multipliers, everything), a)[0]
    return values, ca.Function("plain_second", [*inputs, multipliers], [curvature])


class Both:
    """The condensed motion and the plain rollout of the same case, with scales."""

    def __init__(self, plant, profile, quantities, steps, second, axes=None):
        self.motion = motion = Condensed(plant, profile, steps, quantities)
        self.plain = _plain(plant, profile, steps, quantities, second)
        scale = np.random.default_rng(steps).uniform(0.5, 2.0, motion.scales)
        self.inputs = (np.resize(COEFFICIENTS, profile.size), MOVE, scale)
        self.basis = motion.basis(MOVE, np.eye(profile.size) if axes is None else axes)
        self.symbols = Inputs(
            *(ca.MX.sym("x", x.size) for x in self.inputs), ca.MX.sym("b", motion.basis_size)
        )
        march, first = self.linearised = motion.linearised(self.symbols)
        self._march = self._function(march.arrival, march.outputs)
        self._first = self._function(first.arrival, first.outputs)

    def _function(self, *expressions):
        return ca.Function("of_inputs", [*self.symbols], [*expressions])

    def evaluated(self, *expressions):
        """Numbers of expressions in the symbols, where the case stands."""
        return full(self._function(*expressions)(*self.inputs, self.basis))

    def simulated(self, a):
        """Arrival (states, 1) and outputs (rows, nodes)."""
        return full(self._march(a, *self.inputs[1:], self.basis))

    def firsts(self, a):
        """Derivatives by the coefficients: of the arrival and of the outputs, node by node."""
        return full(self._first(a, *self.inputs[1:], self.basis))

    def curvature(self, of_arrival, of_outputs):
        given = ca.MX(ca.DM(of_arrival)), ca.MX(ca.DM(of_outputs))
        return self.evaluated(self.motion.curvature(self.symbols, self.linearised, *given))[0]


def full(values):
    return [value.full() for value in (values if isinstance(values, list | tuple) else [values])]


def of_bends(case, bends):
    """Second derivatives by the coefficients from those by the power at the nodes."""
    of_power = case.motion.of_group(case.linearised[1].outputs, "power")
    return case.evaluated(case.motion.of_bends(of_power, ca.MX(ca.DM(bends))))[0]
