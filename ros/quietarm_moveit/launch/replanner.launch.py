"""Launch the node with its parameters; move_group runs beside it."""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Describe the node and its three arguments."""
    share = Path(get_package_share_directory("quietarm_moveit"))
    return LaunchDescription(
        [
            DeclareLaunchArgument("robot", description="The robot's file of quietarm, in YAML."),
            DeclareLaunchArgument(
                "quietarm_python",
                description="The interpreter of the environment in which quietarm is installed.",
            ),
            DeclareLaunchArgument(
                "config",
                default_value=str(share / "config" / "replanner.yaml"),
                description="Further parameters.",
            ),
            Node(
                package="quietarm_moveit",
                executable="replanner",
                name="quietarm_replanner",
                output="screen",
                parameters=[
                    LaunchConfiguration("config"),
                    {
                        "robot": LaunchConfiguration("robot"),
                        "quietarm_python": LaunchConfiguration("quietarm_python"),
                    },
                ],
            ),
        ]
    )
