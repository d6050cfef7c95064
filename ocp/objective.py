"""F1, F2 and the diagnostics of a motion: each quantity is defined here, once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from models import Expression
from ocp.collocation import GAUSS_NODES, NODES, mesh
from ocp.task import PointToPoint

_TO_QUADRATIC: list[list[float]] = np.linalg.inv(
    np.array(GAUSS_NODES)[:, None] ** np.arange(3)
).tolist()
_TINY = 1e-300


def resolved_energy(
    power: Sequence[Expression], h: Expression, cubic: Expression = 0.0, quartic: Expression = 0.0
) -> Expression:
    """Integral of |power| with its sign changes resolved: F2 of eqs (11) and (16).

    The power on a step is the quadratic through its three Gauss nodes; its integral is split at
    the quadratic's zeros. Splitting where the power keeps its sign changes nothing, so that zeros
    that are complex or outside the step need no case of their own. Terms of third and fourth degree
    that vanish at the nodes move work across a zero and add none to the step; the zeros stay those
    of the quadratic, since the work hardly changes near a zero.

    Parameters
    ----------
    power : sequence of Expression
        Power at the Gauss nodes of every step [W]: three entries of shape (candidates, steps).
    h : Expression
        Length of every step [s], of the shape of an entry of `power`.
    cubic, quartic : Expression, optional
        Terms of the power beyond the quadratic [W], as by `beyond_quadratic`.

    Returns
    -------
    Expression
        Energy [J], shape (candidates, 1).
    """
    c0, c1, c2 = (
        sum(weight * p for weight, p in zip(row, power, strict=True)) for row in _TO_QUADRATIC
    )
    root = ca.sqrt(ca.fmax(c1 * c1 - 4 * c0 * c2, 0))
    half = -(c1 + ca.copysign(root, c1)) / 2  # the zeros without cancellation
    zeros = [ca.fmin(ca.fmax(r, 0), 1) for r in (half / (c2 + _TINY), c0 / (half + _TINY))]
    breaks = [ca.fmin(*zeros), ca.fmax(*zeros)]
    work = []
    for x in breaks:
        u, bump = x - 0.5, x * (1 - x)
        beyond = bump * (cubic * (bump - 0.2) / 4 - quartic * (u * u * u) / 5)
        work.append(x * (c0 + x * (c1 / 2 + x * (c2 / 3))) + beyond)
    pieces = ca.fabs(work[0]) + ca.fabs(work[1] - work[0]) + ca.fabs(c0 + c1 / 2 + c2 / 3 - work[1])
    return ca.sum2(h * pieces)


@lru_cache(maxsize=32)
def beyond_quadratic(steps: int) -> tuple[ca.DM, ca.DM]:
    """What the neighbouring steps tell of the power on a step, for `resolved_energy`.

    The quartic through five nodes in a row, the step's own three in the middle, is the quadratic
    through these plus (x - node 1)(x - node 2)(x - node 3) (cubic + quartic (x - 1/2)).

    Parameters
    ----------
    steps : int
        Number of steps of `mesh`.

    Returns
    -------
    tuple of DM, each of shape (NODES * steps, steps), sparse
        Weights of `horzcat(*power)` in `cubic` and in `quartic`.
    """
    if steps == 1:
        return ca.DM(NODES, 1), ca.DM(NODES, 1)  # no neighbour
    begin, length = (entry.full() for entry in mesh(ca.DM(np.arange(steps)), steps))
    nodes = (begin + length * np.array(GAUSS_NODES)).ravel()
    step = np.arange(steps)[:, None]
    five = np.clip(NODES * step - 1, 0, len(nodes) - 5) + np.arange(5)
    x = (nodes[five] - begin) / length
    to_quartic = np.linalg.inv(x[:, :, None] ** np.arange(5))
    at = (five % NODES * steps + five // NODES).ravel(), np.repeat(step, 5)
    cubic, quartic = to_quartic[:, 3] + 2 * to_quartic[:, 4], to_quartic[:, 4]
    return (
        ca.DM.triplet(*at, cubic.ravel(), len(nodes), steps),
        ca.DM.triplet(*at, quartic.ravel(), len(nodes), steps),
    )


@dataclass(frozen=True)
class Motion:
    """What a motion costs and asks of the joint, whichever integrator it comes from.

    Attributes
    ----------
    residual : float
        F1: largest absolute tip displacement in the residual window after arrival [m].
    energy : float
        F2: integral of |torque * speed| over the move [J].
    net_work : float
        Integral of torque * speed over the move [J]: what a lossless drive would need.
    peak_torque, peak_speed, peak_acceleration : float
        Largest absolute values during the move [N m, rad/s, rad/s^2].
    peak_deflection : float
        Largest absolute tip displacement during the move [m].
    overshoot : float
        How far the joint passes the target on its way [rad], 0 where it does not.
    """

    residual: float
    energy: float
    net_work: float
    peak_torque: float
    peak_speed: float
    peak_acceleration: float
    peak_deflection: float
    overshoot: float

    def peak(self, name: str) -> float:
        """The residual, or the peak torque, speed, acceleration or deflection, by name."""
        return float(getattr(self, name if name == "residual" else f"peak_{name}"))

    @classmethod
    def from_samples(
        cls,
        task: PointToPoint,
        joint: NDArray[np.float64],
        tips: NDArray[np.float64],
        torque: NDArray[np.float64],
        *,
        residual: float,
        energy: float,
        net_work: float,
    ) -> Motion:
        """Take the peaks from samples during the move.

        Parameters
        ----------
        task : PointToPoint
            The move.
        joint : ndarray, shape (samples, 3)
            Angle, speed, acceleration of the joint [rad, rad/s, rad/s^2].
        tips : ndarray, shape (samples, tips)
            Tip displacements [m].
        torque : ndarray, shape (samples,)
            Joint torque [N m].
        residual, energy, net_work : float
            As in the attributes.

        Returns
        -------
        Motion
            The figures.
        """
        past_target = (joint[:, 0] - task.target) * np.sign(task.span)
        return cls(
            residual=residual,
            energy=energy,
            net_work=net_work,
            peak_torque=float(np.abs(torque).max()),
            peak_speed=float(np.abs(joint[:, 1]).max()),
            peak_acceleration=float(np.abs(joint[:, 2]).max()),
            peak_deflection=float(np.abs(tips).max()),
            overshoot=max(0.0, float(past_target.max())),
        )
