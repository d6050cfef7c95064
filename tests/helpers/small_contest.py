"""A problem that a contest runs on in a moment, and its own code for what contests report."""

import csv
import json
import math

import numpy as np
from quietarm.metaheuristics import problem_of

NAME, OTHER = "single-link-30deg-0.8s-2-terms", "arm-on-flexible-link-90deg-0.8s-2-terms"
TINY = problem_of(NAME)
LINE = f"contest {NAME} --methods nsga2,vepso --runs 2 --evaluations 130 --population 20 --quiet"
METHODS = ("nsga2", "vepso")


def documents(folder, problem=NAME):
    """The runs of a contest as they stand in their files, by method and seed."""
    found = {}
    for path in folder.glob(f"runs/{problem}/*/seed*.json"):
        found[path.parent.name, int(path.stem.removeprefix("seed"))] = json.loads(path.read_text())
    return found


def found(folder):
    """What the runs of a folder found, without the time that it took."""
    kept = {}
    for key, document in documents(folder).items():
        document["front"]["seconds"] = 0
        for mark in document["marks"]:
            mark["seconds"] = 0
        kept[key] = json.dumps(document)
    return kept


def rows_of(folder, table):
    """The rows of a table of a contest, by the names in its heading."""
    return list(csv.DictReader((folder / f"tables/{table}.csv").read_text().splitlines()))


def area(points):
    """What points dominate up to (1.1, 1.1), by adding up rectangles between falling steps."""
    total, height = 0.0, 1.1
    for x, y in sorted(p for p in points if p[0] < 1.1 and p[1] < 1.1):
        if y < height:
            total += (1.1 - x) * (height - y)
            height = y
    return total


def scaled(document):
    """The points of a run's front within the extent of the exact front."""
    (r0, e0), (r1, e1) = document["scale"]["ideal"], document["scale"]["nadir"]
    return [
        ((p["residual"] - r0) / (r1 - r0), (p["energy"] - e0) / (e1 - e0))
        for p in document["front"]["points"]
    ]


def least_energy(points, level):
    """Least energy of points within a residual; infinite where there is none."""
    return min((p["energy"] for p in points if p["residual"] <= level), default=math.inf)


def median_of(values):
    """The middle one, or of two the lower."""
    return float(np.sort(values)[(len(values) - 1) // 2])
