"""One joint motion on perturbed plants: the worst case, what each error adds, sweeps, Monte Carlo.

The joint follows its planned path whatever the plant; energy and torque are what that takes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.ocp.checks import takes, whole
from quietarm.ocp.figures import ENERGY, Figures
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import QUANTITIES, RESIDUAL
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.profiles.shaped_cycloid import TOLERATED
from quietarm.ocp.simulation.evaluator import Evaluator
from quietarm.ocp.simulation.free_vibration import FreeVibration, after_arrival
from quietarm.ocp.simulation.mesh import ROLLOUT_STEPS, default_steps
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.told_progress import Progress
from quietarm.ocp.uncertainty import DAMPING, FREQUENCY, check_ranges

OF_MODES = (FREQUENCY, DAMPING)
_SIDE = 100
"""Errors of a sweep on either side of none."""
_STEP = 1e-4
"""Relative error to either side: of what follows 1e-8 is curvature, and 1e-6 the integrator's."""
_ALONG = {1: 201, 2: 41, 3: 15, 4: 9}
"""Errors along each side of the grid, by the number of ranges."""
_ALONG_ROUGHLY = {1: 51, 2: 21, 3: 9, 4: 5}
"""The same where peaks are looked for that are to become scenarios, or of many motions."""
_ALONG_BY_CVODES = {1: 41, 2: 9, 3: 5, 4: 3}
"""The same where each takes some milliseconds."""

Array = NDArray[np.float64]


def _along_errors(
    candidate: JudgedMotion,
    ranges: Mapping[str, float],
    errors: Array,
    report: Progress | None = None,
) -> Figures:
    """Figures at the nodes of the steps, an entry for each plant, of errors (plants, ranges)."""
    torque = QUANTITIES["torque"]
    steps = _steps_for(candidate.task, ranges)
    evaluator = candidate.by_steps(steps, quantities=[torque], error_names=ranges)
    plants_a_call = 1000
    residuals = list[Array]()
    energies = list[Array]()
    peak_torques = list[Array]()
    for first in range(0, len(errors), plants_a_call):
        block = errors[first : first + plants_a_call]
        evaluation = evaluator([candidate.coefficients], block)
        residuals.append(evaluation.residual[0])
        energies.append(evaluation.energy[0])
        peak_torques.append(evaluation.largest("torque")[0])
        if report is not None:
            report(first + len(block), len(errors))
    return Figures(
        {
            RESIDUAL: np.concatenate(residuals),
            ENERGY: np.concatenate(energies),
            torque.peak: np.concatenate(peak_torques),
        }
    )


def _steps_for(task: PointToPoint, ranges: Mapping[str, float]) -> int:
    """Steps that resolve a move with errors in ranges, any of which may be of a frequency."""
    faster = 1 + max(ranges.values(), default=0.0)
    return max(ROLLOUT_STEPS, int(np.ceil(faster * default_steps(task.certain, least=1))))


def worst_of(candidate: JudgedMotion) -> JudgedMotion | None:
    """A motion along a profile with those errors within its task's ranges that leave most.

    None where the task is certain.
    """
    return next(iter(peaks_between(candidate)), None)


def worst_case(candidate: JudgedMotion, ranges: Mapping[str, float]) -> JudgedMotion:
    """Return the worst case within ranges of errors for a motion without a profile, by CVODES."""

    def residuals(errors: Array) -> Array:
        named_errors = [dict(zip(ranges, row)) for row in errors.tolist()]
        return np.array([candidate.perturbed(row).residual for row in named_errors])

    return _peaks(residuals, candidate, ranges, _ALONG_BY_CVODES[len(ranges)])[0]


@takes(task=PointToPoint, profile=JointProfile)
def worst_of_rows(task: PointToPoint, profile: JointProfile, rows: ArrayLike) -> Array:
    """Return what each row of coefficients leaves at most within a task's ranges [m].

    All rows at all errors of a grid are one evaluation by fixed steps.

    Parameters
    ----------
    rows : array_like, shape (motions, profile.size)

    Returns
    -------
    ndarray, shape (motions,)
    """
    ranges = task.ranges
    steps = _steps_for(task, ranges)
    evaluator = Evaluator(task, profile, steps, quantities=[], error_names=tuple(ranges))
    shares = _grid(np.linspace(-1, 1, _ALONG_ROUGHLY[len(ranges)]), len(ranges))
    errors = shares * np.array(list(ranges.values()))
    return evaluator.residuals(rows, errors).max(axis=1)


def peaks_between(
    candidate: JudgedMotion, most: int = 4, roughly: bool = False
) -> list[JudgedMotion]:
    """The motion where its residual peaks within the ranges, found by fixed steps; worst first.

    On a coarser grid a narrow peak may be missed. A task that is certain has none.
    """
    ranges = candidate.task.ranges
    if not ranges:
        return []

    steps = _steps_for(candidate.task, ranges)
    evaluator = candidate.by_steps(steps, quantities=[], error_names=ranges)

    def residuals(errors: Array) -> Array:
        return evaluator.residuals([candidate.coefficients], errors)[0]

    along = (_ALONG_ROUGHLY if roughly else _ALONG)[len(ranges)]
    return _peaks(residuals, candidate, ranges, along, most)


def _peaks(
    residuals: Callable[[Array], Array],
    candidate: JudgedMotion,
    ranges: Mapping[str, float],
    along: int,
    most: int = 1,
) -> list[JudgedMotion]:
    """Peaks on a grid, refined around each."""
    largest = np.array(list(ranges.values()))
    count = len(ranges)
    beside = _grid([-1.0, -0.5, 0.0, 0.5, 1.0], count)  # in steps of the grid before

    def zoom(peak: Array) -> JudgedMotion:
        for finer in range(3):
            step = 2 / (along - 1) / 2**finer
            around = np.clip(peak + step * beside, -1, 1)
            peak = around[np.argmax(residuals(around * largest))]
        return candidate.perturbed(dict(zip(ranges, (peak * largest).tolist())))

    shares = _grid(np.linspace(-1, 1, along), count)
    values = residuals(shares * largest)
    tops = np.flatnonzero(_is_peak(values.reshape([along] * count)))
    highest = tops[np.argsort(-values[tops])][:most]
    peaks = [zoom(shares[i]) for i in highest]
    return sorted(peaks, key=lambda peak: -peak.residual)


def _grid(along: ArrayLike, ranges: int) -> Array:
    return np.stack(np.meshgrid(*[np.asarray(along)] * ranges), axis=-1).reshape(-1, ranges)


def _is_peak(values: Array) -> NDArray[np.bool_]:
    """Return where a value of a grid is no smaller than its neighbours along every side."""
    peak = np.ones(values.shape, dtype=bool)
    for axis in range(values.ndim):
        peak &= np.diff(values, axis=axis, prepend=-np.inf) >= 0
        peak &= np.diff(values, axis=axis, append=-np.inf) <= 0
    return peak


@dataclass(frozen=True)
class Sensitivity:
    """Derivatives with respect to the relative error of a parameter.

    Attributes
    ----------
    parameter : str
        Its name; ``"frequency"`` and ``"damping"`` are those of all modes.
    energy : float
        Change of energy [J].
    residual : float
        Residual of the change of the state on arrival [m].
    """

    parameter: str
    energy: float
    residual: float


def sensitivities(candidate: JudgedMotion) -> tuple[Sensitivity, ...]:
    """Return sensitivities by central differences of CVODES, that with most vibration first."""
    task = candidate.task
    vibration = after_arrival(task)[0]

    def of(name: str) -> Sensitivity:
        above, below = (candidate.perturbed({name: error}) for error in (_STEP, -_STEP))
        energy = _slope(above.energy, below.energy)
        residual = vibration.peak(_slope(above.arrival, below.arrival))
        return Sensitivity(name, float(energy), float(residual[0]))

    known = (name for name, value in task.plant.measured.items() if value)
    names = dict.fromkeys([*OF_MODES, *known])
    return tuple(sorted(map(of, names), key=lambda sensitivity: -sensitivity.residual))


def sensitivities_of_moves(
    tasks: Sequence[PointToPoint], profile: JointProfile, coefficients: Array
) -> dict[str, tuple[Array, Array]]:
    """Energies and residuals as of `sensitivities`, for many moves of one plant by fixed steps."""
    steps = max(map(default_steps, tasks))
    evaluator = Evaluator(tasks, profile, steps, quantities=(), error_names=OF_MODES)
    both_sides = np.concatenate([np.eye(len(OF_MODES)), -np.eye(len(OF_MODES))])
    evaluation = evaluator(coefficients, _STEP * both_sides)
    above = slice(None, len(OF_MODES))
    below = slice(len(OF_MODES), None)
    energies = _slope(evaluation.energy[:, above], evaluation.energy[:, below])
    arrivals = _slope(evaluation.arrival[:, above], evaluation.arrival[:, below])
    targets = [task.target for task in tasks]
    windows = [task.residual_window for task in tasks]
    vibrations = FreeVibration(tasks[0].plant, targets, windows)
    return {
        name: (energies[:, i], vibrations.peak(arrivals[:, i])) for i, name in enumerate(OF_MODES)
    }


def _slope(above: Any, below: Any) -> Any:
    """Change by a relative error of 1."""
    return (above - below) / (2 * _STEP)


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
        """Return whether the range reaches the lower, the upper end of the sweep."""
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
        return float(np.percentile(self.samples[figure], share))


def tolerated_residual(task: PointToPoint) -> float:
    """The plain cycloid's residual on the nominal plant [m], times `TOLERATED`."""
    return TOLERATED * _plain(task).residual


def _plain(task: PointToPoint) -> JudgedMotion:
    return JudgedMotion.of_profile(task.certain, CycloidPolynomial(0), [])


@takes(candidate=JudgedMotion)
def evaluate_robustness(
    candidate: JudgedMotion,
    ranges: Mapping[str, float],
    *,
    samples: int = 10_000,
    seed: int = 0,
    report: Progress | None = None,
) -> Robustness:
    """Evaluate a motion on perturbed plants.

    Parameters
    ----------
    candidate : JudgedMotion
        The motion along a profile, as `Plan.candidate`; of an uncertain task the nominal plant
        counts.
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
        its contract, or the motion has no profile.
    """
    task = candidate.task
    ranges = check_ranges(task.plant, ranges)
    samples = whole("samples", samples, 1, 1_000_000, "10000 tell percentiles well")
    seed = whole("seed", seed, 0)
    largest = np.array(list(ranges.values()))
    shares = np.arange(-_SIDE, _SIDE + 1) / _SIDE
    alone = [np.outer(shares, error) for error in np.diag(largest)]
    random = np.random.default_rng(seed).uniform(-largest, largest, (samples, len(largest)))
    errors = np.vstack([*alone, random]).astype(float)
    figures = _along_errors(candidate, ranges, errors, report)
    count = len(shares)
    of_sweeps = [figures.take(slice(i * count, (i + 1) * count)) for i in range(len(ranges))]
    sweeps = [
        (name, size * shares, of_sweep) for (name, size), of_sweep in zip(ranges.items(), of_sweeps)
    ]
    cycloid = _plain(task).residual
    return Robustness(
        ranges=ranges,
        cycloid=cycloid,
        assumed=of_sweeps[0].take(slice(_SIDE, _SIDE + 1)),
        sweeps=tuple(_sweep(*sweep, TOLERATED * cycloid) for sweep in sweeps),
        errors=random,
        samples=figures.take(slice(count * len(ranges), None)),
        seed=seed,
    )


def _sweep(name: str, errors: Array, figures: Figures, tolerated: float) -> Sweep:
    """The sweep, with the errors around 0 between which the residual is tolerated."""
    excess = figures.residual - tolerated
    within = None
    if excess[_SIDE] <= 0:
        low = _crossing(errors[_SIDE::-1], excess[_SIDE::-1])
        high = _crossing(errors[_SIDE:], excess[_SIDE:])
        within = low, high
    return Sweep(name, errors, figures, within)


def _crossing(errors: Array, excess: Array) -> float:
    """Return where the excess is first above 0, between two errors; the last error if nowhere."""
    above = np.flatnonzero(excess > 0)
    if not above.size:
        return float(errors[-1])
    around = slice(above[0] - 1, above[0] + 1)
    return float(np.interp(0.0, excess[around], errors[around]))
