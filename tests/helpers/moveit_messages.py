"""Messages of MoveIt 2 as `message_to_ordereddict` of rosidl_runtime_py makes dictionaries of them.

Their entries are those of moveit_msgs 2.6.0 and trajectory_msgs 5.3 (Jazzy).
"""

from array import array


def header(frame=""):
    return {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": frame}


def robot_trajectory(names, rows, frame="world"):
    """A RobotTrajectory of rows (time, positions, speeds, accelerations)."""
    points = [
        {
            "positions": array("d", positions).tolist(),
            "velocities": list(speeds),
            "accelerations": list(accelerations),
            "effort": [],
            "time_from_start": {"sec": int(time), "nanosec": round(time % 1 * 1e9)},
        }
        for time, positions, speeds, accelerations in rows
    ]
    return {
        "joint_trajectory": {
            "header": header(frame),
            "joint_names": list(names),
            "points": points,
        },
        "multi_dof_joint_trajectory": {"header": header(), "joint_names": [], "points": []},
    }


def robot_state(positions):
    """A RobotState by positions of joints."""
    return {
        "joint_state": {
            "header": header("world"),
            "name": list(positions),
            "position": list(positions.values()),
            "velocity": [],
            "effort": [],
        },
        "multi_dof_joint_state": {
            "header": header("world"),
            "joint_names": [],
            "transforms": [],
            "twist": [],
            "wrench": [],
        },
        "attached_collision_objects": [],
        "is_diff": False,
    }


def motion_plan_response(trajectory, start):
    """A MotionPlanResponse with a trajectory from a start state."""
    return {
        "trajectory_start": robot_state(start),
        "group_name": "manipulator",
        "trajectory": trajectory,
        "planning_time": 0.025,
        "error_code": {"val": 1, "message": "", "source": ""},
    }


def along(names, start, end, duration, law, points=9):
    """A RobotTrajectory straight from positions to positions by a law of the speed."""
    rows = list[tuple]()
    for number in range(points):
        time = duration * number / (points - 1)
        place, speed, bend = law(time)
        way = [after - before for before, after in zip(start, end)]
        rows.append((
            time,
            [before + place * step for before, step in zip(start, way)],
            [speed * step for step in way],
            [bend * step for step in way],
        ))  # fmt: skip
    return robot_trajectory(names, rows)
