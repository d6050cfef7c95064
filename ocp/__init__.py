"""What is asked, and the gradient answer."""

# ruff: noqa: E402  # the check must come before anything that imports models
from ocp.shadowing import refuse_shadow

refuse_shadow("models")

from ocp.epsilon import epsilon_front
from ocp.errors import FileFormatError, InfeasibleTaskError, QuietarmError, SolverFailedError
from ocp.floor import energy_floor
from ocp.floor_answer import Floor
from ocp.front import FailedPoint, Front, FrontPoint, Generation, non_dominated, reference_corner
from ocp.objective import Motion
from ocp.plan import Plan, evaluate_coefficients
from ocp.polish import Gain, Polish, polish_front
from ocp.profile import MAX_TERMS, CycloidPolynomial, JointPath, JointProfile
from ocp.provenance import SolveSettings, Verification
from ocp.residual import residual_matrix
from ocp.resimulation import Trajectory, resimulate, sample_trajectory
from ocp.rollout import Rollout, rollout, symbolic_rollout
from ocp.solver import plan_move
from ocp.status import SolveStatus
from ocp.task import PointToPoint
from ocp.weighted import weighted_front

__all__ = [
    "MAX_TERMS",
    "CycloidPolynomial",
    "FailedPoint",
    "FileFormatError",
    "Floor",
    "Front",
    "FrontPoint",
    "Gain",
    "Generation",
    "InfeasibleTaskError",
    "JointPath",
    "JointProfile",
    "Motion",
    "Plan",
    "PointToPoint",
    "Polish",
    "QuietarmError",
    "Rollout",
    "SolveSettings",
    "SolveStatus",
    "SolverFailedError",
    "Trajectory",
    "Verification",
    "energy_floor",
    "epsilon_front",
    "evaluate_coefficients",
    "non_dominated",
    "plan_move",
    "polish_front",
    "reference_corner",
    "residual_matrix",
    "resimulate",
    "rollout",
    "sample_trajectory",
    "symbolic_rollout",
    "weighted_front",
]
