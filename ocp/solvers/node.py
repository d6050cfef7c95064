"""What happens at one time with its derivatives: the joint's path, and the plant at a Gauss node.

Expressions are computed entry by entry over arrays (rows, steps): the derivative by an array of the
same shape is again such an array, the directional derivative along ones. Small matrices of them are
tables: entries by row and column, without those that are zero whatever the symbols.

Both are nonlinear, and both belong to a single time: the modes are linear in all that went before.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import casadi as ca
from quietarm.models import JointMotion, Plant
from quietarm.ocp.energy import Energy, power_of
from quietarm.ocp.limits import Quantity
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.collocation import is_zero
from quietarm.ocp.simulation.grid import Grid
from quietarm.ocp.uncertainty import perturb_plant

Shape = tuple[int, int]
Table = dict[tuple[int, int], ca.MX]


def symbols(count: int, shape: Shape) -> list[ca.MX]:
    """So many arrays of symbols."""
    return [ca.MX.sym("x", *shape) for _ in range(count)]


def derivative(expression: ca.MX, symbol: ca.MX) -> ca.MX:
    """The derivative by an array, entry by entry."""
    return ca.jtimes(expression, symbol, ca.MX.ones(*symbol.shape))


def jacobian(column: Sequence[ca.MX], by: Sequence[ca.MX]) -> Table:
    """First derivatives of a column of expressions."""
    return {
        (i, k): derivative(expression, symbol)
        for i, expression in enumerate(column)
        for k, symbol in enumerate(by)
        if ca.depends_on(expression, symbol)
    }


def hessian(expression: Any, by: Sequence[ca.MX]) -> Table:
    """Second derivatives of an expression."""
    gradient = jacobian([expression], by)
    upper = {
        (i, k): derivative(first, by[k])
        for (_, i), first in gradient.items()
        for (_, k) in gradient
        if i <= k and ca.depends_on(first, by[k])
    }
    return upper | transpose(upper)


def transpose(table: Table) -> Table:
    """Rows for columns."""
    return {(k, i): entry for (i, k), entry in table.items()}


def product(table: Table, column: Sequence[ca.MX], rows: int) -> list[ca.MX]:
    """A table of so many rows times a column."""
    found = dict[int, ca.MX]()
    for (i, k), entry in table.items():
        term = entry * column[k]
        found[i] = found[i] + term if i in found else term
    zero = ca.MX.zeros(*column[0].shape)
    return [found.get(i, zero) for i in range(rows)]


def repeat(entries: Iterable[ca.MX], count: int) -> list[ca.MX]:
    """Each entry so many times beside itself; numbers as they are."""
    return [ca.repmat(x, 1, count) if isinstance(x, ca.MX) else x for x in entries]


def repeat_table(table: Table, count: int) -> Table:
    """The same of a table."""
    return {place: ca.repmat(x, 1, count) for place, x in table.items()}


_CSE = {"cse": True}


class Path:
    """The values y(a, t) through which a profile's coefficients a enter the joint's motion.

    Where the jerk is asked for, y stands once more at the times of `Grid.stretch`, with its rates
    by the fraction of the duration.

    Attributes
    ----------
    linear : bool
        Whether y is linear in the coefficients, with a Jacobian that only depends on the time.
    count : int
        Number of values.
    """

    def __init__(self, profile: JointProfile, steps: int, jerk: bool, shape: Shape) -> None:
        self._profile, self._jerk, self._size = profile, jerk, profile.size
        a, move, at = symbols(profile.size, shape), symbols(3, shape), ca.MX.sym("t", *shape)
        y = [ca.MX.zeros(*shape) + value for value in profile.inner(a, at, *move)]
        self._own = len(y)
        if jerk:
            rates = [derivative(value, at) for value in y]
            y += ca.substitute([*y, *rates], [at], [Grid(steps).stretch(at)])
        self.count = len(y)
        y_a, inputs = jacobian(y, a), [*a, at, *move]
        self._value = ca.Function("y", inputs, y)
        self._jacobian = ca.Function("y_a", inputs, list(y_a.values()), _CSE)
        self._places = list(y_a)
        self.linear = not any(ca.depends_on(x, ca.veccat(*a, *move)) for x in y_a.values())
        if not self.linear:
            multipliers = symbols(self.count, shape)
            y_aa = hessian(sum(w * x for w, x in zip(multipliers, y, strict=True)), a)
            self._bent = list(y_aa)
            self._hessian = ca.Function("y_aa", [*inputs, *multipliers], list(y_aa.values()), _CSE)

    def value(self, a: Sequence[ca.MX], at: ca.DM, move: Sequence[ca.MX]) -> list[ca.MX]:
        """The values y."""
        return self._value.call([*a, ca.MX(at), *move], True, False)

    def jacobian(self, a: Sequence[ca.MX], at: ca.DM, move: Sequence[ca.MX]) -> Table:
        """Derivatives of y by the coefficients; numbers where y is linear."""
        if self.linear:
            one = ca.DM.ones(*at.shape)
            entries = self._jacobian.call([*[one] * self._size, at, *[one] * 3])
            return {place: ca.MX(x) for place, x in zip(self._places, entries, strict=True)}
        entries = self._jacobian.call([*a, ca.MX(at), *move], True, False)
        return dict(zip(self._places, entries, strict=True))

    def hessian(
        self, a: Sequence[ca.MX], at: ca.DM, move: Sequence[ca.MX], multipliers: Sequence[ca.MX]
    ) -> Table:
        """Second derivatives by the coefficients of the sum of multipliers times y."""
        entries = self._hessian.call([*a, ca.MX(at), *move, *multipliers], True, False)
        return dict(zip(self._bent, entries, strict=True))

    def motion(self, y: Sequence[ca.MX], move: Sequence[ca.MX]) -> JointMotion:
        """The joint's motion, without its jerk."""
        return self._profile.outer(y[: self._own], *move)

    def motion_with_jerk(self, y: Sequence[ca.MX], move: Sequence[ca.MX]) -> JointMotion:
        """The same with the jerk where that is asked for; y are symbols."""
        joint = self.motion(y, move)
        if not self._jerk:
            return joint
        there, rates = y[self._own : 2 * self._own], y[2 * self._own :]
        by_y = jacobian([self.motion(there, move).acceleration], there)
        return joint._replace(jerk=sum(x * rates[k] for (_, k), x in by_y.items()) / move[2])


class Node:
    """A Gauss node: what forces the modes, f, and the outputs o of the point v = (y, W, W', W'').

    The outputs are the power, the energy's smooth part where it has one, and the values of the
    limited quantities.

    Attributes
    ----------
    count : int
        Number of outputs.
    own : int
        How many of them, the first, belong to the energy.
    """

    def __init__(
        self,
        plant: Plant,
        path: Path,
        quantities: Sequence[Quantity],
        names: Sequence[str],
        energy: Energy,
        shape: Shape,
    ) -> None:
        m, zero = plant.modes, ca.MX.zeros(*shape)
        y, modes, move = symbols(path.count, shape), symbols(3 * m, shape), symbols(3, shape)
        errors = symbols(len(names), shape)
        W, dW, ddW = modes[:m], modes[m : 2 * m], modes[2 * m :]
        joint, v = path.motion_with_jerk(y, move), [*y, *modes]
        perturbed = perturb_plant(plant, dict(zip(names, errors, strict=True)))
        f = [zero + x for x in perturbed.modal_accelerations(joint, W, dW)]
        torque, tips = perturbed.torque(joint, W, dW, ddW), perturbed.tip_displacements(W)
        smooth = energy.smooth(torque, joint.speed)
        own = [power_of(torque, joint.speed), *([] if is_zero(smooth) else [smooth])]
        limited = [x for quantity in quantities for x in quantity.of(joint, tips, torque)]
        o = [zero + x for x in (*own, *limited)]
        self.own, self.count = len(own), len(o)
        f_y, o_v, inputs = jacobian(f, y), jacobian(o, v), [*v, *move, *errors]
        self._places = list(f_y), list(o_v)
        self._first = ca.Function("node", inputs, [*o, *f_y.values(), *o_v.values()], _CSE)
        multipliers = symbols(m + self.count, shape)
        l_vv = hessian(sum(w * x for w, x in zip(multipliers, [*f, *o], strict=True)), v)
        self._bent = list(l_vv)
        self._second = ca.Function("l_vv", [*inputs, *multipliers], list(l_vv.values()), _CSE)

    def evaluate(self, point: Sequence[ca.MX]) -> tuple[list[ca.MX], Table, Table]:
        """The outputs, the Jacobian of f by y, and that of the outputs by v.

        A point is v, then the move and the errors.
        """
        entries = iter(self._first.call(point, True, False))
        outputs = [next(entries) for _ in range(self.count)]
        f_y, o_v = ({place: next(entries) for place in places} for places in self._places)
        return outputs, f_y, o_v

    def hessian(self, point: Sequence[ca.MX], multipliers: Sequence[ca.MX]) -> Table:
        """Second derivatives by v of the sum of multipliers times f, then outputs."""
        entries = self._second.call([*point, *multipliers], True, False)
        return dict(zip(self._bent, entries, strict=True))
