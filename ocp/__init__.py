"""What is asked, and the gradient answer.

The rooms, each of which may import those before it: `base`, `task`, `profiles`, `simulation`,
`robustness`, `program` and `answers`, `plan`, `front` and `floor`. All of them may import
`models`; what a user needs is here.
"""

# ruff: noqa: E402  # the check must come before anything that imports models
from ocp.base.shadowing import refuse_shadow

refuse_shadow("models")

from ocp.answers.provenance import SolveSettings, Verification
from ocp.base.errors import FileFormatError, InfeasibleTaskError, QuietarmError, SolverFailedError
from ocp.base.status import SolveStatus
from ocp.floor.answer import Floor, FloorSettings
from ocp.floor.search import energy_floor
from ocp.front.answer import Front, reference_corner
from ocp.front.crosscheck import CrossCheck, cross_check
from ocp.front.epsilon import epsilon_front
from ocp.front.points import FailedPoint, FrontPoint, Generation, non_dominated
from ocp.front.polish import Gain, Polish, polish_front
from ocp.front.weighted import weighted_front
from ocp.plan.answer import Plan, evaluate_coefficients
from ocp.plan.many import Moves, plan_moves
from ocp.plan.shaping import shaped_cycloid
from ocp.plan.solver import plan_move
from ocp.profiles.gaussians import CycloidGaussians
from ocp.profiles.joint_profile import JointPath, JointProfile
from ocp.profiles.network import CycloidNetwork
from ocp.profiles.polynomial import MAX_TERMS, CycloidPolynomial
from ocp.profiles.shaped_cycloid import ShapedCycloid
from ocp.profiles.spline import CycloidSpline
from ocp.robustness.measures import Robustness, Sweep, evaluate_robustness
from ocp.robustness.population import Figures
from ocp.robustness.uncertain import UncertainPlant
from ocp.robustness.worst import Worst
from ocp.simulation.cvodes import Trajectory
from ocp.simulation.errors import with_errors
from ocp.simulation.objective import Motion
from ocp.simulation.residual import residual_matrix
from ocp.simulation.resimulation import resimulate, sample_trajectory
from ocp.simulation.rollout import Rollout, rollout, symbolic_rollout
from ocp.task.point_to_point import PointToPoint

__all__ = [
    "MAX_TERMS",
    "CrossCheck",
    "CycloidGaussians",
    "CycloidNetwork",
    "CycloidPolynomial",
    "CycloidSpline",
    "FailedPoint",
    "Figures",
    "FileFormatError",
    "Floor",
    "FloorSettings",
    "Front",
    "FrontPoint",
    "Gain",
    "Generation",
    "InfeasibleTaskError",
    "JointPath",
    "JointProfile",
    "Motion",
    "Moves",
    "Plan",
    "PointToPoint",
    "Polish",
    "QuietarmError",
    "Robustness",
    "Rollout",
    "ShapedCycloid",
    "SolveSettings",
    "SolveStatus",
    "SolverFailedError",
    "Sweep",
    "Trajectory",
    "UncertainPlant",
    "Verification",
    "Worst",
    "cross_check",
    "energy_floor",
    "epsilon_front",
    "evaluate_coefficients",
    "evaluate_robustness",
    "non_dominated",
    "plan_move",
    "plan_moves",
    "polish_front",
    "reference_corner",
    "residual_matrix",
    "resimulate",
    "rollout",
    "sample_trajectory",
    "shaped_cycloid",
    "symbolic_rollout",
    "weighted_front",
    "with_errors",
]
