"""What is read from files: a claim until its plant has borne it out."""

from __future__ import annotations

from pathlib import Path

from metaheuristics.objective.claims import check_figures
from ocp import Front


def load_front(path: Path) -> Front:
    """The front of a file, of which motions were evaluated again: a file is a claim.

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
