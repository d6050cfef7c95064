"""The planner: a process of quietarm's own Python that reads messages and writes answers.

The ROS 2 of Ubuntu 24.04 has NumPy 1.26, and quietarm needs NumPy 2.2: they cannot share a process.
A line in is a JSON object, and so is a line out; the first line in has the robot and the options.
This file needs quietarm, and no ROS.
"""

import contextlib
import json
import sys
from collections.abc import Callable, Mapping
from typing import Any, TextIO

from quietarm import QuietarmError, Robot
from quietarm.studies import MessagePlanner

NO_PLAN = "no plan"
INVALID = "invalid"
"""Kinds of errors: within limits there is none, or the message or an option cannot be used."""


def main() -> None:
    """Answer standard input until it ends; what others print goes to standard error."""
    answers = sys.stdout
    with contextlib.redirect_stdout(sys.stderr):
        serve(sys.stdin, answers)


def serve(questions: TextIO, answers: TextIO) -> None:
    """Answer a line each; without a robot that can be read, the first alone."""
    planner: MessagePlanner | None = None
    for line in questions:
        question = json.loads(line)
        if planner is None:
            planner, answer = begin(question)
        else:
            answer = answer_of(planner, question)
        answers.write(json.dumps(answer) + "\n")
        answers.flush()
        if planner is None:
            return


def begin(question: Mapping[str, Any]) -> tuple[MessagePlanner | None, dict[str, Any]]:
    """The planner of a robot's file and options, and words on it."""
    options = dict(question)
    planner = list[MessagePlanner]()

    def load() -> dict[str, Any]:
        robot = Robot.load(options.pop("robot"))
        planner.append(MessagePlanner(robot, **options))
        notes = [note.words for note in robot.notes]
        return {"robot": robot.description.name, "joints": list(robot.joints), "notes": notes}

    answer = _attempted(load)
    return (planner[0] if planner else None), answer


def answer_of(planner: MessagePlanner, question: Mapping[str, Any]) -> dict[str, Any]:
    """The trajectory that is asked for with a report, or an error with its kind."""

    def plan() -> dict[str, Any]:
        planned = planner.plan(
            question["message"],
            speed_scale=float(question.get("speed_scale", 1.0)),
            acceleration_scale=float(question.get("acceleration_scale", 1.0)),
        )
        return {
            "message": planned.message,
            "report": planned.report,
            "remarks": list(planned.remarks),
        }

    return _attempted(plan)


def _attempted(attempt: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """Return what an attempt gives, or its error in one line."""
    try:
        return attempt()
    except QuietarmError as error:
        return {"error": _one_line(error), "kind": NO_PLAN}
    except (ValueError, TypeError, KeyError, OSError) as error:
        return {"error": _one_line(error), "kind": INVALID}


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


if __name__ == "__main__":
    main()
