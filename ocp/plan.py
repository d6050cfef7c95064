"""Plan: the answer a person keeps."""

from __future__ import annotations

import io
import math
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ocp.checks import finite, positive, whole
from ocp.documents import (
    Document,
    numbers_of,
    profile_from_document,
    profile_to_document,
    read_document,
    reading,
    task_from_document,
    task_to_document,
    versions,
    write_document,
)
from ocp.files import write_whole
from ocp.objective import Motion
from ocp.profile import CycloidPolynomial, JointPath, JointProfile
from ocp.readonly import ReadOnlyDict
from ocp.resimulation import Trajectory, resimulate, sample_trajectory
from ocp.rollout import rollout
from ocp.status import SolveStatus
from ocp.task import PointToPoint

FORMAT, VERSION = "quietarm-plan", 1
_LEAST_TICKS, _MOST_SAMPLES = 1e-4, 10_000_000


@dataclass(frozen=True)
class SolveSettings:
    """What was asked of the solver beyond the task; see `ocp.plan_move` for the meanings.

    Raises
    ------
    ValueError
        When a setting is out of range.
    """

    residual_limit: float = 0.0
    bound: float | None = None
    starts: int = 4
    seed: int = 0
    steps: int | None = None

    def __post_init__(self) -> None:
        limit = finite("residual limit", self.residual_limit, "m")
        if limit < 0:
            raise ValueError(f"residual limit is {limit:g} m; give 0 (at rest) or more")
        object.__setattr__(self, "residual_limit", limit)
        if self.bound is not None:
            object.__setattr__(self, "bound", positive("bound on the coefficients", self.bound))
        for name, least in (("starts", 1), ("seed", 0), ("steps", 1)):
            value = getattr(self, name)
            if value is not None or name != "steps":
                object.__setattr__(self, name, whole(name, value, least))


@dataclass(frozen=True)
class Verification:
    """How far the fixed steps that the answer was found with are from the independent integrator.

    Attributes
    ----------
    steps : int
        Fixed steps.
    fixed_step_energy, fixed_step_residual : float
        F2 [J] and F1 [m] by the fixed steps.
    energy_difference, residual_difference : float
        Those less the independent integrator's [J, m].
    """

    steps: int
    fixed_step_energy: float
    fixed_step_residual: float
    energy_difference: float
    residual_difference: float

    @classmethod
    def between(cls, steps: int, energy: float, residual: float, motion: Motion) -> Verification:
        """Compare fixed-step figures [J, m] with those of CVODES."""
        return cls(steps, energy, residual, energy - motion.energy, residual - motion.residual)


@dataclass(frozen=True)
class Provenance:
    """What is needed to get an answer again.

    Attributes
    ----------
    method : str
        ``"ipopt"``, ``"given coefficients"`` or the name of a metaheuristic.
    settings : dict
        What was asked of the method, the seed included.
    versions : dict of str to str
        Versions of quietarm, casadi, numpy and Python.
    seconds : float
        How long it took; not compared.
    """

    method: str
    settings: Mapping[str, str | int | float | None]
    versions: Mapping[str, str] = field(default_factory=versions)
    seconds: float = field(default=0.0, compare=False)

    def __post_init__(self) -> None:
        for name in ("settings", "versions"):
            object.__setattr__(self, name, ReadOnlyDict(getattr(self, name)))


@dataclass(frozen=True)
class Plan:
    """One motion of one task: its coefficients and what it costs.

    Attributes
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    coefficients : tuple of float
        The profile's coefficients, a_1 to a_N of eq (6).
    motion : Motion
        Residual, energy and diagnostics, by the independent integrator.
    status : SolveStatus
        How the solve ended.
    verification : Verification
        Distance between the two integrators.
    provenance : Provenance
        Method, settings, versions, time.
    """

    task: PointToPoint
    profile: JointProfile
    coefficients: tuple[float, ...]
    motion: Motion
    status: SolveStatus
    verification: Verification
    provenance: Provenance

    @property
    def residual(self) -> float:
        """F1: largest absolute tip displacement after arrival [m]."""
        return self.motion.residual

    @property
    def energy(self) -> float:
        """F2: driving energy [J]."""
        return self.motion.energy

    @property
    def path(self) -> JointPath:
        """The joint's motion as a callable of time and derivative order."""
        return self.profile.path(self.coefficients, *self.task.move)

    def trajectory(self, times: ArrayLike) -> Trajectory:
        """Sample the motion with CVODES; see `ocp.sample_trajectory`."""
        return sample_trajectory(self.task, self.profile, self.coefficients, times)

    def save(self, path: str | Path) -> None:
        """Write the plan as JSON; ValueError when the file cannot be written."""
        write_document(path, FORMAT, VERSION, self.to_document())

    @classmethod
    def load(cls, path: str | Path) -> Plan:
        """Read a plan that `save` wrote.

        Parameters
        ----------
        path : str or Path
            The file.

        Returns
        -------
        Plan
            A plan equal to the one saved.

        Raises
        ------
        FileFormatError
            When the file is not a plan, not whole, or of a newer version.
        """
        document = read_document(path, FORMAT, VERSION)
        with reading(path, "plan"):
            return cls.from_document(document)

    def to_document(self) -> Document:
        """The plan in JSON's types, SI units and radians."""
        diagnostics = asdict(self.motion)
        return {
            **task_to_document(self.task),
            "profile": profile_to_document(self.profile),
            "coefficients": list(self.coefficients),
            "residual": diagnostics.pop("residual"),
            "energy": diagnostics.pop("energy"),
            "diagnostics": diagnostics,
            "status": self.status.value,
            "verification": asdict(self.verification),
            "provenance": vars(self.provenance),
        }

    @classmethod
    def from_document(cls, document: Document) -> Plan:
        """The plan of a document; KeyError, TypeError or ValueError where it is not one."""
        profile = profile_from_document(document["profile"])
        figures = {
            "residual": document["residual"],
            "energy": document["energy"],
            **document["diagnostics"],
        }
        return cls(
            task=task_from_document(document),
            profile=profile,
            coefficients=profile.checked(document["coefficients"]),
            motion=Motion(**numbers_of(figures, [entry.name for entry in fields(Motion)])),
            status=SolveStatus(document["status"]),
            verification=verification_of(document["verification"]),
            provenance=provenance_of(document["provenance"]),
        )

    def save_csv(self, path: str | Path, sample_rate: float = 1000.0) -> None:
        """Write the move as a table to drive a joint with.

        Parameters
        ----------
        path : str or Path
            The file; its header names the quantities with their units.
        sample_rate : float
            Rows per second [Hz]. The last row is the first tick at or after arrival, where the
            joint rests at its target.

        Raises
        ------
        ValueError
            When the rate is out of range or the file cannot be written.
        """
        ticks = ticks_of_move(self.task.duration, sample_rate)
        sampled = self.trajectory(np.arange(ticks + 1) / sample_rate)
        tips = sampled.tips.shape[1]
        tip_names = ["tip_m"] if tips == 1 else [f"tip_{i + 1}_m" for i in range(tips)]
        header = ["t_s", "theta_rad", "dtheta_rad_s", "ddtheta_rad_s2", *tip_names]
        header += ["torque_Nm", "power_W"]
        table = np.column_stack(
            [sampled.time, sampled.joint, sampled.tips, sampled.torque, sampled.power]
        )
        text = io.StringIO()
        np.savetxt(text, table, delimiter=",", header=",".join(header), comments="", fmt="%.10g")
        write_whole(path, text.getvalue())


def evaluate_coefficients(
    task: PointToPoint,
    coefficients: ArrayLike,
    *,
    method: str = "given coefficients",
    settings: Mapping[str, str | int | float | None] | None = None,
) -> Plan:
    """The figures of given coefficients of the cycloid of a polynomial.

    Parameters
    ----------
    task : PointToPoint
        The move.
    coefficients : array_like, shape (terms,)
        a_1 to a_N of eq (6); none for the plain cycloid.
    method : str
        Where the coefficients come from, for the plan's provenance.
    settings : mapping, optional
        Settings of that method.

    Returns
    -------
    Plan
        A plan whose status says that nothing was optimised.

    Raises
    ------
    ValueError
        When there are too many coefficients or one is not finite.
    SolverFailedError
        When CVODES cannot follow the motion.
    """
    began = time.perf_counter()
    profile = CycloidPolynomial(int(np.atleast_1d(np.asarray(coefficients, dtype=float)).size))
    checked = profile.checked(coefficients)
    motion = resimulate(task, profile, checked)
    fixed = rollout(task, profile, checked)
    return Plan(
        task=task,
        profile=profile,
        coefficients=checked,
        motion=motion,
        status=SolveStatus.NOT_OPTIMISED,
        verification=Verification.between(
            fixed.steps, fixed.motion.energy, fixed.motion.residual, motion
        ),
        provenance=Provenance(method, settings or {}, seconds=time.perf_counter() - began),
    )


def ticks_of_move(duration: float, sample_rate: float) -> int:
    """Ticks from the start to the first at or after arrival.

    Parameters
    ----------
    duration : float
        Travelling time [s].
    sample_rate : float
        Ticks per second [Hz].

    Returns
    -------
    int
        The last tick's number, 1 or more.

    Raises
    ------
    ValueError
        When the rate is not positive and finite, or asks for more rows than a table should have.
    """
    ticks = duration * positive("sample rate", sample_rate, "Hz")
    if ticks < _LEAST_TICKS:
        raise ValueError(
            f"sample rate is {sample_rate:g} Hz, a tick long after the arrival; give a higher rate"
        )
    if ticks > _MOST_SAMPLES:
        raise ValueError(
            f"sample rate {sample_rate:g} Hz asks for {ticks:.0f} rows; give a lower rate"
        )
    return max(1, math.ceil(ticks - 1e-9))


def verification_of(document: Document) -> Verification:
    """The verification of a document; KeyError, TypeError or ValueError where it is not one."""
    names = [entry.name for entry in fields(Verification) if entry.name != "steps"]
    return Verification(whole("steps", document["steps"], 1), **numbers_of(document, names))


def provenance_of(document: Document) -> Provenance:
    """The provenance of a document; KeyError, TypeError or ValueError where it is not one."""
    for name in ("settings", "versions"):
        if not isinstance(document[name], dict):
            raise ValueError(f"{name} is {document[name]!r}, not a table of names and values")
    finite("seconds", document["seconds"], "s")
    return Provenance(**document)
