"""What happens at one time, as functions of numbers: the joint's path, and the plant at a node.

Second derivatives belong to a single node, since the modes are linear in all that went before.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
from quietarm.models import Expression, JointMotion, Plant
from quietarm.ocp.energy import Energy, power_of
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.collocation import is_zero
from quietarm.ocp.simulation.grid import Grid
from quietarm.ocp.task import QUANTITIES
from quietarm.ocp.uncertainty import perturb_plant

Places = list[tuple[int, int]]
"""Rows and columns of a matrix's nonzeros."""


class PathFunctions:
    """What of the joint's path depends on the coefficients at one time, as functions of numbers.

    Where the jerk is asked for, also at the time of `Grid.stretch`, with its rates by the fraction.

    Attributes
    ----------
    linear : bool
        Whether it is linear in the coefficients, by slopes that only depend on the time.
    value, first : Function
        (coefficients, fraction, move) -> inner; its derivatives by the coefficients, dense.
    second : Function
        (coefficients, fraction, move, multipliers of inner) -> second derivatives.
    """

    def __init__(self, profile: JointProfile, steps: int, jerk: bool) -> None:
        self.profile = profile
        a, fraction, move = ca.SX.sym("a", profile.size), ca.SX.sym("t"), ca.SX.sym("move", 3)
        moves = ca.vertsplit(move)
        inner = ca.vertcat(*profile.inner(ca.vertsplit(a), fraction, *moves))
        self._own = inner.numel()
        if jerk:
            with_rates = ca.vertcat(inner, ca.jacobian(inner, fraction))
            at = Grid(steps).stretch(fraction)
            inner = ca.vertcat(inner, ca.substitute(with_rates, fraction, at))
        self.count = inner.numel()
        first, weights = ca.densify(ca.jacobian(inner, a)), ca.SX.sym("w", self.count)
        second = ca.densify(ca.hessian(ca.dot(weights, inner), a)[0])
        self.linear = not ca.depends_on(first, ca.vertcat(a, move))
        inputs, options = [a, fraction, move], {"cse": True}
        self.value = ca.Function("inner", inputs, [inner], options)
        self.first = ca.Function("slopes", inputs, [first], options)
        self.second = ca.Function("bends", [*inputs, weights], [second], options)

    def motion(self, inner: ca.SX, move: ca.SX) -> JointMotion:
        """The joint at a node, with its jerk where that is asked for."""
        moves = ca.vertsplit(move)

        def outer(values: ca.SX) -> JointMotion:
            return self.profile.outer(ca.vertsplit(values), *moves)

        joint = outer(inner[: self._own])
        if inner.numel() == self._own:
            return joint
        values, rates = ca.vertsplit(inner[self._own :], self._own)
        jerk = ca.jtimes(outer(values).acceleration, values, rates) / move[2]
        return joint._replace(jerk=jerk)

    def slopes(self, fractions: ca.DM) -> list[list[ca.DM]]:
        """Where it is linear: for each coefficient and value of inner a row over the fractions."""
        count, size = fractions.numel(), self.profile.size
        table = self.first(ca.DM.zeros(size, count), fractions, ca.DM.ones(3, count)).full()
        by_entry = table.reshape(self.count, count, size)
        return [[ca.DM(by_entry[i, :, n]).T for i in range(self.count)] for n in range(size)]


class NodeFunctions:
    """What happens at a node, as functions of numbers.

    Attributes
    ----------
    rows : list of int
        How many outputs the energy has, the first of them the power, and each limited quantity.
    first : Function
        (inner, modes, move, errors) -> outputs; derivatives of what forces the modes by inner; of
        the outputs by inner and modes. The modes are W, W' and W''.
    second : Function
        (inner, modes, move, errors, multipliers of forcing, of outputs) -> second derivatives by
        inner and modes.
    by_inner, by_point, bends : list of (int, int)
        Where the nonzeros of the three stand.
    """

    def __init__(
        self,
        plant: Plant,
        path: PathFunctions,
        quantities: Sequence[str],
        names: Sequence[str],
        energy: Energy,
    ) -> None:
        inner, move, errors = (ca.SX.sym("x", n) for n in (path.count, 3, len(names)))
        modes = ca.SX.sym("modes", 3 * plant.modes)
        joint, point = path.motion(inner, move), ca.vertcat(inner, modes)
        W, dW, ddW = (ca.vertsplit(part) for part in ca.vertsplit(modes, plant.modes))
        wrong = perturb_plant(plant, dict(zip(names, ca.vertsplit(errors), strict=True)))
        forcing = ca.vertcat(*wrong.modal_accelerations(joint, W, dW))
        torque, tips = wrong.torque(joint, W, dW, ddW), wrong.tip_displacements(W)
        smooth = energy.smooth(torque, joint.speed)
        values = [[power_of(torque, joint.speed), *([] if is_zero(smooth) else [smooth])]]
        values += [list(QUANTITIES[name].of(joint, tips, torque)) for name in quantities]
        self.rows = [len(of) for of in values]
        outputs = ca.vertcat(*(one for of in values for one in of))
        inputs = [inner, modes, move, errors]
        by_inner, by_point = ca.jacobian(forcing, inner), ca.jacobian(outputs, point)
        of_forcing, of_outputs = (ca.SX.sym("w", one.numel()) for one in (forcing, outputs))
        lagrangian = ca.dot(of_forcing, forcing) + ca.dot(of_outputs, outputs)
        bends = ca.hessian(lagrangian, point)[0]
        self.by_inner, self.by_point, self.bends = map(_nonzeros, (by_inner, by_point, bends))
        first, options = [ca.densify(outputs), by_inner, by_point], {"cse": True}
        self.first = ca.Function("node", inputs, first, options)
        inputs += [of_forcing, of_outputs]
        self.second = ca.Function("node_second", inputs, [bends], options)


def _nonzeros(matrix: ca.SX) -> Places:
    return list(zip(*matrix.sparsity().get_triplet(), strict=True))


def elementwise(function: ca.Function, *inputs: Sequence[Expression]) -> list[list[ca.MX]]:
    """Apply a function of SX columns entry by entry, each operation to all entries at once.

    For each argument its entries, arrays of one shape or scalars; for each result its nonzeros, in
    the order of its sparsity.
    """
    shape = next((x.shape for of in inputs for x in of if isinstance(x, ca.MX)), (1, 1))
    results = [[ca.MX()] * function.nnz_out(i) for i in range(function.n_out())]
    work: dict[int, ca.MX] = {}
    for k in range(function.n_instructions()):
        operation, where = function.instruction_id(k), function.instruction_output(k)
        of = function.instruction_input(k)
        if operation == ca.OP_OUTPUT:
            value = work[of[0]]
            results[where[0]][where[1]] = (
                value if value.shape == shape else ca.repmat(value, *shape)
            )
        elif operation == ca.OP_INPUT:
            work[where[0]] = ca.MX(inputs[of[0]][of[1]])
        elif operation == ca.OP_CONST:
            work[where[0]] = ca.MX(function.instruction_constant(k))
        elif len(of) == 1:
            work[where[0]] = ca.MX.unary(operation, work[of[0]])
        else:
            work[where[0]] = ca.MX.binary(operation, work[of[0]], work[of[1]])
    return results
