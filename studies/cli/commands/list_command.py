"""`quietarm list`: plants with their parameters, problems, methods, objectives."""

from __future__ import annotations

import click

from quietarm.metaheuristics.problems.catalogue import PROBLEMS, drawn_problems, problem_of
from quietarm.models import Robot, known_plants
from quietarm.ocp import Front
from quietarm.studies.cli.given import Given
from quietarm.studies.cli.options import ENDS, ROBOT_PATH, command
from quietarm.studies.cli.outputs import FOLDER, finish, output_option
from quietarm.studies.cli.plants import OF_ROBOTS
from quietarm.studies.cli.robot_options import path_of
from quietarm.views.report.catalogue_rows import KINDS, catalogue_rows, drawn_rows
from quietarm.views.report.robot_rows import robot_rows, robot_words, usual_path
from quietarm.views.report.saving import inside
from quietarm.views.report.words import counted


@command(
    click.Argument(["names"], nargs=-1, metavar="[plants|problems|drawn|methods|objectives|NAME|"
                   "ROBOT.yaml]..."),
    *ENDS, *ROBOT_PATH,
    output_option({FOLDER: "the reference fronts of the problems"}),
)  # fmt: skip
def list_(given: Given) -> None:
    """List plants, problems, methods and objectives; or one of them by its name.

    A plant comes with the value, unit, meaning and source of its parameters, a problem with its
    move and box, a method with its settings; `drawn` are the random moves of docs/results; a robot,
    by its file, comes with its masses, joints, springs and limits, and with modes and sag along a
    path.

    \b
    Examples:
      quietarm list
      quietarm list single-link
      quietarm list plants --plant-file crane.py
      quietarm list single-link-30deg-0.8s --output fronts
      quietarm list nsga2
      quietarm list ur5_bar.yaml --start=0,-80deg,97deg,-107deg,-90deg,0 \\
          --target=80deg,-57deg,69deg,-75deg,-69deg,34deg
    """  # noqa: D301  # \b is click's: do not rewrap
    names = given.names or KINDS
    shown = list[str | list[tuple[str, str]]]()
    plants = given.plant_file or known_plants()
    for name in names:
        if name.endswith(OF_ROBOTS):
            robot = Robot.load(name)
            asked = path_of(given, robot)
            path = robot.along(asked or usual_path(robot)).path
            way = "the path" if asked else "a straight path of its joints"
            shown += [robot_words(robot, path, way), robot_rows(robot, path)]
            continue
        of_all = name == "drawn" and not given.names  # beside all else the groups will do
        title, rows = drawn_rows(names=False) if of_all else catalogue_rows(name, plants)
        shown += [f"{title}:", [(f"  {entry}", words) for entry, words in rows]]
    problems = [name for name in names if name in PROBLEMS or name in drawn_problems()]
    if "problems" in names:
        problems = [*PROBLEMS, *(name for name in problems if name not in PROBLEMS)]
    if given.output and not problems:
        raise ValueError("--output is for the reference fronts of problems; name one")
    for folder in given.output:
        fronts = dict[str, Front]()
        for name in problems:
            problem = problem_of(name)
            fronts |= zip(problem.tasks(), problem.fronts())
            fronts[name] = problem.front()  # of all objectives
        saves = {f"{name}.json": front.save for name, front in fronts.items()}
        for path, save in inside(folder, saves):
            save(path)
        shown.append(f"wrote {counted(len(fronts), 'front')} to {folder}")
    finish([], *shown)
