"""The node: MoveIt's messages to dictionaries, to the planner, and back.

Service `~/plan_kinematic_path` (moveit_msgs/GetMotionPlan) is that of MoveIt's move_group, whose
trajectory it plans anew; one that stands in the request's reference_trajectories is planned anew
without asking MoveIt. Topic `~/trajectory` (moveit_msgs/RobotTrajectory) is answered on
`~/planned_trajectory`.
"""

import time
from typing import Any

import rclpy
from moveit_msgs.msg import MoveItErrorCodes, RobotTrajectory
from moveit_msgs.srv import GetMotionPlan
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rosidl_runtime_py.convert import message_to_ordereddict
from rosidl_runtime_py.set_message import set_message_fields

from quietarm_moveit.planner_process import PlannerError, PlannerProcess

OPTIONS = {
    "duration": 0.0,
    "slowest": 2.0,
    "path_tolerance": 0.005,
    "rate": 100.0,
    "thin": 0.0,
    "terms": 12,
    "payload": 1.0,
    "in_full": False,
    "judge": True,
}
"""Parameters that are fields of `quietarm.studies.MessagePlanner`, with its defaults."""
SOURCE = "quietarm_moveit"


class Replanner(Node):
    """A node that plans trajectories of MoveIt anew."""

    def __init__(self) -> None:
        super().__init__("quietarm_replanner")
        options = {
            name: self.declare_parameter(name, default).value for name, default in OPTIONS.items()
        }
        robot = self.declare_parameter("robot", "").value
        python = self.declare_parameter("quietarm_python", "python3").value
        moveit = self.declare_parameter("move_group_service", "plan_kinematic_path").value
        self.planner = PlannerProcess(python, {"robot": robot, **options})
        for words in self.planner.robot["notes"]:
            self.get_logger().warning(words)
        group = ReentrantCallbackGroup()  # MoveIt's answer arrives while a request waits for it
        self.move_group = self.create_client(GetMotionPlan, moveit, callback_group=group)
        self.create_service(GetMotionPlan, "~/plan_kinematic_path", self.plan, callback_group=group)
        self.planned = self.create_publisher(RobotTrajectory, "~/planned_trajectory", 1)
        self.create_subscription(
            RobotTrajectory, "~/trajectory", self.plan_topic, 1, callback_group=group
        )
        joints = ", ".join(self.planner.robot["joints"])
        self.get_logger().info(f"ready: {self.planner.robot['robot']}, joints {joints}")

    async def plan(
        self, request: GetMotionPlan.Request, response: GetMotionPlan.Response
    ) -> GetMotionPlan.Response:
        """Answer a request: by MoveIt's answer, or the request's own trajectory, planned anew."""
        asked = request.motion_plan_request
        given = [
            trajectory
            for reference in asked.reference_trajectories
            for trajectory in reference.joint_trajectory
        ]
        answer = response.motion_plan_response
        if given:
            answer.trajectory.joint_trajectory = given[0]
            answer.trajectory_start = asked.start_state
            answer.group_name = asked.group_name
        elif not self.move_group.service_is_ready():
            words = f"no service {self.move_group.srv_name} of MoveIt; is move_group running?"
            return self._failed(response, MoveItErrorCodes.COMMUNICATION_FAILURE, words)
        else:
            of_moveit = await self.move_group.call_async(request)
            answer = response.motion_plan_response = of_moveit.motion_plan_response
            if answer.error_code.val != MoveItErrorCodes.SUCCESS:
                return response
        question = {
            "message": message_to_ordereddict(answer),
            "speed_scale": asked.max_velocity_scaling_factor,
            "acceleration_scale": asked.max_acceleration_scaling_factor,
        }
        began = time.monotonic()
        planned = self._ask(question)
        if "error" in planned:
            codes = {"no plan": MoveItErrorCodes.PLANNING_FAILED}
            code = codes.get(planned["kind"], MoveItErrorCodes.INVALID_MOTION_PLAN)
            return self._failed(response, code, planned["error"])
        answer.trajectory = _trajectory(planned)
        answer.planning_time += time.monotonic() - began
        answer.error_code.val = MoveItErrorCodes.SUCCESS
        answer.error_code.message = planned["report"]
        answer.error_code.source = SOURCE
        return response

    def plan_topic(self, message: RobotTrajectory) -> None:
        """Publish the trajectory of a topic planned anew; an error goes to the log."""
        planned = self._ask({"message": message_to_ordereddict(message)})
        if "error" not in planned:
            self.planned.publish(_trajectory(planned))

    def _ask(self, question: dict[str, Any]) -> dict[str, Any]:
        """Return the planner's answer; its report and remarks go to the log."""
        try:
            planned = self.planner.ask(question)
        except PlannerError as error:
            planned = {"error": str(error), "kind": "ended"}
        if "error" in planned:
            self.get_logger().error(planned["error"])
            return planned
        for words in planned["remarks"]:
            self.get_logger().info(words)
        self.get_logger().info(planned["report"])
        return planned

    def _failed(
        self, response: GetMotionPlan.Response, code: int, words: str
    ) -> GetMotionPlan.Response:
        """A response without a trajectory: one that rings must not be taken for a still one."""
        answer = response.motion_plan_response
        answer.trajectory = RobotTrajectory()
        answer.error_code.val = code
        answer.error_code.message = words
        answer.error_code.source = SOURCE
        return response


def _trajectory(planned: dict[str, Any]) -> RobotTrajectory:
    trajectory = RobotTrajectory()
    set_message_fields(trajectory, planned["message"])
    return trajectory


def main() -> None:
    """Run the node until it is interrupted."""
    rclpy.init()
    node = None
    try:
        node = Replanner()
        executor = MultiThreadedExecutor(num_threads=2)
        executor.add_node(node)
        executor.spin()
    except PlannerError as error:
        raise SystemExit(f"quietarm_replanner: {error}") from None
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        if node is not None:
            node.planner.close()
            node.destroy_node()
        rclpy.try_shutdown()
