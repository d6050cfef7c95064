"""Stand-ins for what the node imports of ROS 2: messages whose fields are Jazzy's, and a Node.

They show that the node's own lines run; that ROS does the same they cannot show.
"""

import sys
from copy import deepcopy
from types import ModuleType, SimpleNamespace
from typing import ClassVar

from moveit_messages import motion_plan_response, robot_state, robot_trajectory

CODES = {
    "SUCCESS": 1, "PLANNING_FAILED": -1, "INVALID_MOTION_PLAN": -2, "COMMUNICATION_FAILURE": -25,
}  # fmt: skip
"""Of moveit_msgs/MoveItErrorCodes."""


class Message(SimpleNamespace):
    """A message by its fields, those that are messages as well."""


def message_of(value):
    """A message of a dictionary, as a field of ROS has it."""
    if isinstance(value, dict):
        return Message(**{name: message_of(entry) for name, entry in value.items()})
    return [message_of(entry) for entry in value] if isinstance(value, list) else value


def dictionary_of(value):
    if isinstance(value, Message):
        return {name: dictionary_of(entry) for name, entry in vars(value).items()}
    return [dictionary_of(entry) for entry in value] if isinstance(value, list) else value


def set_fields(message, values):
    for name, value in values.items():
        assert hasattr(message, name)  # ROS raises for a field that it does not have
        setattr(message, name, message_of(deepcopy(value)))


class Trajectory(Message):
    def __init__(self, **entries):
        super().__init__(**(entries or vars(message_of(robot_trajectory([], [])))))


def request(references=(), speed=1.0, acceleration=0.5):
    """A GetMotionPlan request, with the fields that the node reads."""
    generic = [Message(joint_trajectory=[entry], cartesian_trajectory=[]) for entry in references]
    return Message(
        motion_plan_request=Message(
            start_state=message_of(robot_state({})),
            group_name="arm",
            reference_trajectories=generic,
            max_velocity_scaling_factor=speed, max_acceleration_scaling_factor=acceleration,
        )
    )  # fmt: skip


def empty_response():
    answer = message_of(motion_plan_response(robot_trajectory([], []), {}))
    answer.error_code.val = 0
    return Message(motion_plan_response=answer)


class Client:
    """MoveIt's service, which answers at once with what was given."""

    srv_name = "plan_kinematic_path"
    answer = None

    def service_is_ready(self):
        return self.answer is not None

    async def call_async(self, asked):
        return Message(motion_plan_response=self.answer)


class Node:
    overrides: ClassVar = {}

    def __init__(self, name):
        self.name = name
        self.log = []
        self.published = []

    def declare_parameter(self, name, default):
        return Message(value=self.overrides.get(name, default))

    def get_logger(self):
        return SimpleNamespace(**dict.fromkeys(("info", "warning", "error"), self.log.append))

    def create_client(self, kind, name, callback_group):
        return Client()

    def create_service(self, kind, name, callback, callback_group):
        self.service = (name, callback)

    def create_publisher(self, kind, name, depth):
        return SimpleNamespace(publish=self.published.append)

    def create_subscription(self, kind, name, callback, depth, callback_group):
        self.subscription = (name, callback)


def install(monkeypatch):
    """Put the stand-ins where the node's imports find them."""
    service = SimpleNamespace(Request=Message, Response=Message)
    modules = {
        "rclpy": {},
        "rclpy.node": {"Node": Node},
        "rclpy.callback_groups": {"ReentrantCallbackGroup": object},
        "rclpy.executors": {
            "ExternalShutdownException": KeyError, "MultiThreadedExecutor": object,
        },
        "moveit_msgs": {},
        "moveit_msgs.msg": {
            "MoveItErrorCodes": SimpleNamespace(**CODES), "RobotTrajectory": Trajectory,
        },
        "moveit_msgs.srv": {"GetMotionPlan": service},
        "rosidl_runtime_py": {},
        "rosidl_runtime_py.convert": {"message_to_ordereddict": dictionary_of},
        "rosidl_runtime_py.set_message": {"set_message_fields": set_fields},
    }  # fmt: skip
    for name, entries in modules.items():
        module = ModuleType(name)
        vars(module).update(entries)
        monkeypatch.setitem(sys.modules, name, module)
