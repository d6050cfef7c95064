"""The figures of a motion over errors of the plant: sweeps, insensitivity, Monte Carlo."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.ocp.candidate import Candidate
from quietarm.ocp.checks import whole
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.robustness.population import ErrorPopulation, Figures
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.uncertainty import check_ranges

TOLERATED = 0.05
"""Share of the plain cycloid's residual up to which a motion counts as insensitive."""
MOST_SAMPLES = 1_000_000
_SIDE = 100
"""Errors of a sweep on either side of none."""

Report = Callable[[int, int], object]


@dataclass(frozen=True, eq=False)
class Sweep:
    """A motion over the errors of one thing, all else as assumed.

    Attributes
    ----------
    name : str
        ``"frequency"``, ``"damping"`` or a parameter.
    errors : ndarray, shape (errors,)
        Relative errors, even from minus to plus the range; 0 in the middle.
    figures : Figures
        What the motion leaves and costs at each.
    insensitivity : tuple of float, or None
        The errors around 0 between which the residual stays within `Robustness.tolerated`; None
        where it is above already without an error. At an end of the sweep it may reach farther.
    """

    name: str
    errors: NDArray[np.float64]
    figures: Figures
    insensitivity: tuple[float, float] | None

    def __post_init__(self) -> None:
        self.errors.setflags(write=False)

    @property
    def width(self) -> float:
        """Width of the insensitivity range, 0 where there is none."""
        return 0.0 if self.insensitivity is None else float(np.ptp(self.insensitivity))

    @property
    def open_ends(self) -> tuple[bool, bool]:
        """Whether the range reaches the lower, the upper end of the sweep."""
        low, high = self.insensitivity or (0.0, 0.0)
        return bool(low <= self.errors[0]), bool(high >= self.errors[-1])


@dataclass(frozen=True, eq=False)
class Robustness:
    """What a motion leaves and costs when the plant is not the assumed one.

    Attributes
    ----------
    ranges : dict of str to float
        Largest relative errors by name.
    cycloid : float
        Residual of the plain cycloid of the same duration on the assumed plant [m].
    assumed : Figures
        The motion on the assumed plant, one entry.
    sweeps : tuple of Sweep
        One for every name.
    errors : ndarray, shape (samples, names)
        Errors of the Monte Carlo samples, all at once, uniform within the ranges.
    samples : Figures
        What the motion leaves and costs at each.
    seed : int
        Of the samples.
    """

    ranges: Mapping[str, float]
    cycloid: float
    assumed: Figures
    sweeps: tuple[Sweep, ...]
    errors: NDArray[np.float64]
    samples: Figures
    seed: int

    def __post_init__(self) -> None:
        object.__setattr__(self, "ranges", dict(self.ranges))
        self.errors.setflags(write=False)

    @property
    def tolerated(self) -> float:
        """Residual up to which the motion counts as insensitive [m]."""
        return TOLERATED * self.cycloid

    def percentile(self, figure: str, share: float) -> float:
        """A percentile of the samples.

        Parameters
        ----------
        figure : str
            ``"residual"``, ``"energy"`` or ``"peak_torque"``.
        share : float
            Percentage, 100 for the largest.

        Returns
        -------
        float
            The value that this share of the samples stays within, in SI units.
        """
        return float(np.percentile(getattr(self.samples, figure), share))


def tolerated_residual(task: PointToPoint) -> float:
    """`TOLERATED` of what the plain cycloid of the same duration leaves on the assumed plant [m].

    A motion is insensitive to errors within which it leaves no more.
    """
    return TOLERATED * _plain(task).residual


def quiet_residual(task: PointToPoint) -> float:
    """`TOLERATED` of how far the plain cycloid bends the assumed plant's tip on its way [m].

    Unlike what the cycloid leaves, this has no zeros: it falls steadily with the duration.
    """
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
    """Evaluate a motion over errors of its plant.

    Parameters
    ----------
    task : PointToPoint
        The move; of an uncertain plant the assumed one counts.
    profile : JointProfile
        How the joint moves.
    coefficients : array_like, shape (profile.size,)
        The profile's coefficients.
    ranges : mapping of str to float
        Largest relative errors, as 0.1 for 10 %: of ``"frequency"`` and ``"damping"``, which all
        modes have alike, and of any parameter of the plant by its name.
    samples : int
        Monte Carlo samples, uniform within all ranges at once.
    seed : int
        Of these.
    report : callable, optional
        Is told how many evaluations of how many are done.

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
    task = task.certain
    ranges = check_ranges(task.plant, ranges)
    samples = whole("samples", samples, 1, MOST_SAMPLES, "10000 tell percentiles well")
    seed = whole("seed", seed, 0)
    population = ErrorPopulation(task, profile, coefficients, ranges)
    largest = np.array(list(ranges.values()))
    shares = np.arange(-_SIDE, _SIDE + 1) / _SIDE
    alone = [np.outer(shares, unit * largest) for unit in np.eye(len(largest))]
    random = np.random.default_rng(seed).uniform(-largest, largest, (samples, len(largest)))
    found = population(np.vstack([*alone, random]), report)
    cycloid = _plain(task).residual
    sweeps = tuple(
        _sweep(name, size * shares, found.part(i * len(shares), len(shares)), TOLERATED * cycloid)
        for i, (name, size) in enumerate(ranges.items())
    )
    return Robustness(
        ranges=ranges, cycloid=cycloid, assumed=found.part(_SIDE, 1), sweeps=sweeps,
        errors=random, samples=found.part(len(sweeps) * len(shares), samples), seed=seed,
    )  # fmt: skip


def _sweep(name: str, errors: NDArray[np.float64], figures: Figures, tolerated: float) -> Sweep:
    excess = figures.residual - tolerated
    within: tuple[float, float] | None = None
    if excess[_SIDE] <= 0:
        low, high = (_crossing(errors[_SIDE::side], excess[_SIDE::side]) for side in (-1, 1))
        within = low, high
    return Sweep(name, errors, figures, within)


def _crossing(errors: NDArray[np.float64], excess: NDArray[np.float64]) -> float:
    """Where the excess is first above 0, between two errors; the last error if it never is."""
    above = np.flatnonzero(excess > 0)
    if not above.size:
        return float(errors[-1])
    i = above[0]
    share = excess[i - 1] / (excess[i - 1] - excess[i])
    return float(errors[i - 1] + share * (errors[i] - errors[i - 1]))
