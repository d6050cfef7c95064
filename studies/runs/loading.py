"""What is read from files; its figures are checked against the plant first."""

from __future__ import annotations

from pathlib import Path

from metaheuristics.objective.claims import check_figures, check_plan
from ocp import Front, Plan


def load_front(path: Path) -> Front:
    """The front of a file, after some of its motions were evaluated again.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    Front
        The front.

    Raises
    ------
    FileFormatError
        When the file is no front.
    ValueError
        When its figures are not those of its motions.
    """
    front = Front.load(path)
    check_figures(front, str(path))
    return front


def load_plan(path: Path) -> Plan:
    """The plan of a file, after its motion was evaluated again.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    Plan
        The plan.

    Raises
    ------
    FileFormatError
        When the file is no plan.
    ValueError
        When its figures are not those of its motion.
    """
    plan = Plan.load(path)
    check_plan(plan, str(path))
    return plan
