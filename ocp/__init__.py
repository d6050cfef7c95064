"""What is asked, and the gradient answer.

The rooms, each of which may import those before it: `base`, `task`, `profiles`, `simulation`,
`robustness`, `program` and `answers`, `plan`, `front` and `floor`. All of them may import
`models`; what a user needs is here.
"""

from quietarm.ocp.answers.provenance import SolveSettings, Verification
from quietarm.ocp.base.errors import (
    FileFormatError,
    InfeasibleTaskError,
    QuietarmError,
    SolverFailedError,
)
from quietarm.ocp.base.status import SolveStatus
from quietarm.ocp.floor.answer import Floor, FloorSettings
from quietarm.ocp.floor.search import energy_floor
from quietarm.ocp.front.answer import Front, reference_corner
from quietarm.ocp.front.crosscheck import CrossCheck, cross_check
from quietarm.ocp.front.epsilon import epsilon_front
from quietarm.ocp.front.points import FailedPoint, FrontPoint, Generation, non_dominated
from quietarm.ocp.front.polish import Gain, Polish, polish_front
from quietarm.ocp.front.weighted import weighted_front
from quietarm.ocp.plan.answer import Plan, evaluate_coefficients
from quietarm.ocp.plan.many import Moves, plan_moves
from quietarm.ocp.plan.shaping import shaped_cycloid
from quietarm.ocp.plan.solver import plan_move
from quietarm.ocp.profiles.gaussians import CycloidGaussians
from quietarm.ocp.profiles.joint_profile import JointPath, JointProfile
from quietarm.ocp.profiles.network import CycloidNetwork
from quietarm.ocp.profiles.polynomial import MAX_TERMS, CycloidPolynomial
from quietarm.ocp.profiles.shaped_cycloid import ShapedCycloid
from quietarm.ocp.profiles.spline import CycloidSpline
from quietarm.ocp.robustness.measures import Robustness, Sweep, evaluate_robustness
from quietarm.ocp.robustness.population import Figures
from quietarm.ocp.robustness.uncertain import UncertainPlant
from quietarm.ocp.robustness.worst import Worst
from quietarm.ocp.simulation.cvodes import Trajectory
from quietarm.ocp.simulation.errors import with_errors
from quietarm.ocp.simulation.objective import Motion
from quietarm.ocp.simulation.residual import residual_matrix
from quietarm.ocp.simulation.resimulation import resimulate, sample_trajectory
from quietarm.ocp.simulation.rollout import Rollout, rollout, symbolic_rollout
from quietarm.ocp.task.point_to_point import PointToPoint

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
