"""Values and derivatives at one time: the joint's path, and the plant at a Gauss node.

Both are nonlinear, and both belong to a single time: the modes are linear in all that went before.
So expressions are computed entry by entry over arrays (rows, nodes), as are their derivatives.
Small matrices of such arrays are tables: entries by row and column, without those that are zero
whatever the symbols.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models import JointMotion
from quietarm.models.joint_motion import is_zero
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.sample import sample_plant
from quietarm.ocp.simulation.mesh import Mesh
from quietarm.ocp.simulation.objective import smooth_power
from quietarm.ocp.simulation.rollout import Simulation
from quietarm.ocp.uncertainty import perturb_plant

Array = NDArray[np.float64]
Shape = tuple[int, int]
PathTable = dict[tuple[int, int], ca.MX]


def symbols(count: int, shape: Shape) -> list[ca.MX]:
    """So many arrays of symbols."""
    return [ca.MX.sym("x", *shape) for _ in range(count)]


def jacobian(column: Sequence[ca.MX], by: Sequence[ca.MX]) -> PathTable:
    """First derivatives of a column of expressions, entry by entry."""
    if not column:
        return {}
    unit = ca.MX.ones(*column[0].shape)
    zero = ca.MX(*column[0].shape)
    places = range(len(by))
    seeds = [[unit if place == k else zero for place in places] for k in places]
    columns = ca.forward([*column], [*by], seeds)
    return {
        (i, k): entry
        for k, along in enumerate(columns)
        for i, entry in enumerate(along)
        if not entry.is_zero()
    }


def hessian(expression: Any, by: Sequence[ca.MX], earlier_first: bool = False) -> PathTable:
    """Second derivatives of an expression, of which one of each pair is computed.

    It is the derivative along the later symbol of that by the earlier one, or else the other way
    round: that costs less where the expression is costly to differentiate by the earlier symbols.
    """
    (gradient,) = ca.reverse(
        [expression],
        [*by],
        [[ca.MX.ones(*expression.shape)]],
    )
    twice = jacobian(gradient, by)
    half = {
        (row, column): entry
        for (row, column), entry in twice.items()
        if (row >= column if earlier_first else row <= column)
    }
    return half | transpose(half)


def transpose(table: PathTable) -> PathTable:
    """Rows for columns."""
    return {(k, i): entry for (i, k), entry in table.items()}


def product(table: PathTable, column: Sequence[ca.MX], rows: int) -> list[ca.MX]:
    """A table of so many rows times a column."""
    sums = dict[int, ca.MX]()
    for (i, k), entry in table.items():
        term = entry * column[k]
        sums[i] = sums[i] + term if i in sums else term
    if not rows:
        return []
    zero = ca.MX.zeros(*column[0].shape)
    return [sums.get(i, zero) for i in range(rows)]


class TableFunction:
    """Tables as a function of their symbols."""

    def __init__(self, inputs: Sequence[ca.MX], *tables: PathTable) -> None:
        self._places = [list(table) for table in tables]
        entries = [entry for table in tables for entry in table.values()]
        self._function = ca.Function("tables", [*inputs], entries, {"cse": True})

    def __call__(self, *arguments: Sequence[Any]) -> list[dict[tuple[int, int], Any]]:
        """The tables in expressions, or in numbers."""
        inputs = [x for part in arguments for x in part]
        inline = any(isinstance(x, ca.MX) for x in inputs)
        entries = iter(self._function.call(inputs, inline, False))
        return [{place: next(entries) for place in places} for places in self._places]


class Path:
    """The values y(a, t) through which a profile's coefficients a enter the joint's motion.

    Where the jerk is asked for, y stands once more at the times of `Mesh.stretch`, with its rates
    by the fraction of the duration. Coefficients and the move are arrays like the times. There are
    `count` values, `linear` in the coefficients or not: then the Jacobian depends on time alone.
    """

    def __init__(self, profile: JointProfile, mesh: Mesh, jerk: bool, rows: int) -> None:
        times, _ = mesh.columns(rows)
        self._profile = profile
        self._jerk = jerk
        self._times = ca.horzcat(*times)
        shape = self._times.shape
        a = symbols(profile.size, shape)
        move = symbols(3, shape)
        at = ca.MX.sym("t", *shape)
        derivatives = profile.at_duration(move[2]).derivatives(a, at)
        y = [ca.MX.zeros(*shape) + value for value in derivatives]
        self._count = len(y)
        if jerk:
            rates = product(jacobian(y, [at]), [ca.MX.ones(*shape)], len(y))
            y += ca.substitute([*y, *rates], [at], [mesh.stretch(at)])
        self.count = len(y)
        inputs = [*a, at, *move]
        y_a = jacobian(y, a)
        self.linear = not ca.depends_on(ca.veccat(*y_a.values()), ca.veccat(*a, *move))
        self._value = ca.Function("y", inputs, y)
        self._jacobian = TableFunction(inputs, y_a)
        if not self.linear:
            multipliers = symbols(self.count, shape)
            lagrangian = sum(w * x for w, x in zip(multipliers, y))
            self._hessian = TableFunction([*inputs, *multipliers], hessian(lagrangian, a))

    def value(self, a: Sequence[ca.MX], move: Sequence[ca.MX]) -> list[ca.MX]:
        """The values y at the nodes."""
        return self._value.call([*a, self._times, *move], True, False)

    def jacobian(self, a: Sequence[Any], move: Sequence[Any]) -> dict[tuple[int, int], Any]:
        """Derivatives of y by the coefficients; numbers where y is linear."""
        if self.linear:  # in them it depends on time alone
            unit = ca.DM.ones(*self._times.shape)
            a = [unit] * len(a)
            move = [unit] * 3
        (table,) = self._jacobian(a, [self._times], move)
        return table

    def hessian(
        self, a: Sequence[ca.MX], move: Sequence[ca.MX], multipliers: Sequence[ca.MX]
    ) -> PathTable:
        """Second derivatives by the coefficients of the sum of multipliers times y."""
        (table,) = self._hessian(a, [self._times], move, multipliers)
        return table

    def motion(self, y: Sequence[ca.MX], move: Sequence[ca.MX]) -> JointMotion:
        """The joint's motion, without its jerk."""
        value, rate, bend = y[: self._count]
        return self._profile.motion_of((value, rate, bend), *move)

    def motion_with_jerk(self, y: Sequence[ca.MX], move: Sequence[ca.MX]) -> JointMotion:
        """Return the joint's motion, with the jerk if that is asked for; y are symbols."""
        joint = self.motion(y, move)
        if not self._jerk:
            return joint
        there = y[self._count : 2 * self._count]
        rates = y[2 * self._count :]
        (jerk,) = product(
            jacobian([self.motion(there, move).acceleration], there),
            rates,
            1,
        )
        return joint._replace(jerk=jerk / move[2])


class TabulatedPath(Path):
    """A path that is linear in the coefficients, whose values by each are numbers."""

    linear = True

    def __init__(
        self, profile: JointProfile, mesh: Mesh, jerk: bool, rows: int, table: Array
    ) -> None:
        """The table is that of the profile at the nodes, which are those of the jerk as well."""
        self._profile = profile
        self._jerk = jerk
        self._rows = rows
        self._count = 3
        orders = [0, 1, 2, *([0, 1, 2, 1, 2, 3] if jerk else [])]
        self.count = len(orders)
        self._tables = [table[:, order] for order in orders]

    def value(self, a: Sequence[ca.MX], move: Sequence[ca.MX]) -> list[ca.MX]:
        """The values y at the nodes: a product of all coefficients, alike in all columns."""
        del move
        row = ca.horzcat(*(of_one[:, 0] for of_one in a))
        return [
            ca.repmat(ca.DM(table[:1]), self._rows, 1)
            + ca.mtimes(row, ca.sparsify(ca.DM(table[1:])))
            for table in self._tables
        ]

    def jacobian(self, a: Sequence[Any], move: Sequence[Any]) -> dict[tuple[int, int], Any]:
        """Derivatives of y by the coefficients, numbers."""
        del move
        return {
            (k, n): ca.repmat(ca.DM(table[1 + n][None]), self._rows, 1)
            for k, table in enumerate(self._tables)
            for n in range(len(a))
        }


@lru_cache(maxsize=8)
def path_of(profile: JointProfile, mesh: Mesh, jerk: bool, rows: int) -> Path:
    """A path, kept for the next who asks for it."""
    table = profile.table(mesh.nodes.ravel()) if mesh.breaks or not jerk else None
    if table is None:
        return Path(profile, mesh, jerk, rows)
    return TabulatedPath(profile, mesh, jerk, rows, table)


class Node:
    """A Gauss node: what forces the modes, f, and the outputs o of the point v = (y, W, W', W'').

    The outputs are the joints' `powers`, the energy's smooth part where it has one, and the values
    of the limited quantities: `count` in all, of which the first `of_energy` belong to the energy.
    Where only arrivals are asked for there are none.
    """

    def __init__(
        self,
        simulation: Simulation,
        path: Path,
        shape: Shape,
        only_arrivals: bool = False,
    ) -> None:
        m = simulation.plant.modes
        zero = ca.MX.zeros(*shape)
        y = symbols(path.count, shape)
        modes = symbols(3 * m, shape)
        move = symbols(3, shape)
        errors = symbols(len(simulation.errors), shape)
        W = modes[:m]
        dW = modes[m : 2 * m]
        ddW = modes[2 * m :]
        joint = path.motion_with_jerk(y, move)
        v = [*y, *modes]
        perturbed = perturb_plant(simulation.plant, dict(zip(simulation.errors, errors)))
        f = [zero + x for x in perturbed.modal_accelerations(joint, W, dW)]
        sample = sample_plant(perturbed, joint, W, dW, ddW)
        powers = [] if only_arrivals else [*sample.powers]
        smooth = 0.0 if only_arrivals else smooth_power(simulation.energy, sample)
        of_energy = [*powers, *([] if is_zero(smooth) else [smooth])]
        quantities = () if only_arrivals else simulation.quantities
        limited = [x for quantity in quantities for x in quantity.values(sample)]
        o = [zero + x for x in (*of_energy, *limited)]
        inputs = [*v, *move, *errors]
        self.powers = len(powers)
        self.of_energy = len(of_energy)
        self.count = len(o)
        outputs = {(i, 0): x for i, x in enumerate(o)}
        self._first = TableFunction(inputs, outputs, jacobian(f, y), jacobian(o, v))
        multipliers = symbols(m + self.count, shape)
        lagrangian = sum(w * x for w, x in zip(multipliers, [*f, *o]))
        # the place on a path of several joints, the first of v, enters through tables
        by_place_first = len(sample.joints) > 1
        self._second = TableFunction(
            [*inputs, *multipliers], hessian(lagrangian, v, by_place_first)
        )

    def evaluate(self, point: Sequence[ca.MX]) -> tuple[list[ca.MX], PathTable, PathTable]:
        """The outputs, the Jacobian of f by y, and that of the outputs by v.

        A point is v, then the move and the errors.
        """
        outputs, f_y, o_v = self._first(point)
        return list(outputs.values()), f_y, o_v

    def hessian(self, point: Sequence[ca.MX], multipliers: Sequence[ca.MX]) -> PathTable:
        """Second derivatives by v of the sum of multipliers times f, then outputs."""
        (table,) = self._second(point, multipliers)
        return table
