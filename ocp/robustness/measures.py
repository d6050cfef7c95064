"""The figures of a motion over errors of the plant: sweeps, insensitivity, Monte Carlo."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.ocp.candidate import Candidate
from quietarm.ocp.checks import whole
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.profiles.shaped_cycloid import TOLERATED
from quietarm.ocp.robustness.perturbed import Report, perturbed_figures
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.uncertainty import check_ranges

MOST_SAMPLES = 1_000_000
_SIDE = 100
"""Errors of a sweep on either side of none."""

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Figures:
    """F1 [m], F2 [J] and peak torque [N m] at the nodes of the steps: an entry for each plant."""

    residual: Array
    energy: Array
    peak_torque: Array


@dataclass(frozen=True, eq=False)
class Sweep:
    """A motion over one parameter error, all other parameters nominal.

    Attributes
    ----------
    name : str
        ``"frequency"``, ``"damping"`` or a parameter.
    errors : ndarray, shape (errors,)
        Relative errors, even from minus to plus the range; 0 in the middle.
    figures : Figures
        Residual, energy and peak torque at each.
    insensitivity : tuple of float, or None
        The errors around 0 between which the residual stays within `Robustness.tolerated`, or the
        ends of the sweep; None if it is larger even without an error.
    """

    name: str
    errors: Array
    figures: Figures
    insensitivity: tuple[float, float] | None

    @property
    def open_ends(self) -> tuple[bool, bool]:
        """Whether the range reaches the lower, the upper end of the sweep."""
        low, high = self.insensitivity or (0.0, 0.0)
        return bool(low <= self.errors[0]), bool(high >= self.errors[-1])


@dataclass(frozen=True, eq=False)
class Robustness:
    """Residual and energy of a motion on perturbed plants.

    Attributes
    ----------
    ranges : dict of str to float
        Largest relative errors by name; there is one of the `sweeps` for each.
    cycloid : float
        Residual of the plain cycloid of the same duration on the nominal plant [m].
    errors : ndarray, shape (samples, names)
        Errors of the Monte Carlo `samples`, all at once, uniform within the ranges.
    """

    ranges: Mapping[str, float]
    cycloid: float
    assumed: Figures
    sweeps: tuple[Sweep, ...]
    errors: Array
    samples: Figures
    seed: int

    @property
    def tolerated(self) -> float:
        """Residual up to which the motion counts as insensitive [m]."""
        return TOLERATED * self.cycloid

    def percentile(self, figure: str, share: float) -> float:
        """A percentile of the samples, of a quantity by its name."""
        return float(np.percentile(getattr(self.samples, figure), share))


def tolerated_residual(task: PointToPoint) -> float:
    """The plain cycloid's residual on the nominal plant [m], times `TOLERATED`."""
    return TOLERATED * _plain(task).residual


def quiet_residual(task: PointToPoint) -> float:
    """Its peak deflection [m], times `TOLERATED`: over durations this has no zeros."""
    return TOLERATED * _plain(task).motion.peak_deflection


def _plain(task: PointToPoint) -> Candidate:
    return Candidate.of_profile(task.certain, CycloidPolynomial(0), [])


@one_at_a_time
def evaluate_robustness(
    task: PointToPoint,
    profile: JointProfile,
    coefficients: ArrayLike,
    ranges: Mapping[str, float],
    *,
    samples: int = 10_000,
    seed: int = 0,
    report: Report | None = None,
) -> Robustness:
    """Evaluate a motion on perturbed plants.

    Parameters
    ----------
    task : PointToPoint
        The move; of an uncertain task the nominal plant counts.
    profile : JointProfile
        How the joint moves, with these `coefficients`.
    ranges : mapping of str to float
        Largest relative errors by name, as of `Uncertainty`.
    samples, seed : int
        Monte Carlo samples, uniform within all ranges at once, and their seed.
    report : callable, optional
        Called with the number of evaluations done and of all.

    Returns
    -------
    Robustness
        Sweeps over each error alone, and the samples.

    Raises
    ------
    ValueError
        When there is no such parameter, a number is out of range, a plant within the ranges breaks
        its contract, or the coefficients or the duration do not fit the profile.
    """
    ranges = check_ranges(task.plant, ranges)
    samples = whole("samples", samples, 1, MOST_SAMPLES, "10000 tell percentiles well")
    seed = whole("seed", seed, 0)
    largest = np.array(list(ranges.values()))
    shares = np.arange(-_SIDE, _SIDE + 1) / _SIDE
    alone = [np.outer(shares, own) for own in np.diag(largest)]
    random = np.random.default_rng(seed).uniform(-largest, largest, (samples, len(largest)))
    every = np.vstack([*alone, random]).astype(float)
    found = perturbed_figures(task, profile, coefficients, ranges, every, report)
    *swept, sampled = np.split(found, len(shares) * np.arange(1, len(ranges) + 1))
    cycloid = _plain(task).residual
    return Robustness(
        ranges=ranges,
        cycloid=cycloid,
        assumed=Figures(*swept[0][[_SIDE]].T),
        sweeps=tuple(
            _sweep(name, size * shares, Figures(*rows.T), TOLERATED * cycloid)
            for (name, size), rows in zip(ranges.items(), swept, strict=True)
        ),
        errors=random,
        samples=Figures(*sampled.T),
        seed=seed,
    )


def _sweep(name: str, errors: Array, figures: Figures, tolerated: float) -> Sweep:
    excess, within = figures.residual - tolerated, None
    if excess[_SIDE] <= 0:
        low, high = (_crossing(errors[_SIDE::side], excess[_SIDE::side]) for side in (-1, 1))
        within = low, high
    return Sweep(name, errors, figures, within)


def _crossing(errors: Array, excess: Array) -> float:
    """Where the excess is first above 0, between two errors; the last error if it never is."""
    above = np.flatnonzero(excess > 0)
    if not above.size:
        return float(errors[-1])
    around = slice(above[0] - 1, above[0] + 1)
    return float(np.interp(0.0, excess[around], errors[around]))
