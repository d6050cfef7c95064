"""The runs of a contest for others' tools: IOHanalyzer and COCO."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import moocore
import numpy as np
from quietarm.metaheuristics import PROBLEMS
from quietarm.ocp.files import write_whole
from quietarm.studies.contest.measures import Arena
from quietarm.studies.display.saving import File

_COLUMNS = ("evaluations", "missing", "function", "algorithm", "dimension", "run")


def ioh_file(path: Path | None, arenas: Sequence[Arena]) -> File:
    """A csv that IOHanalyzer reads by the names of its columns (`read_pure_csv`).

    ``missing`` is the share of the exact front's hypervolume that is missing, to be minimised.
    Runs of which the end alone is known are left out.
    """
    return path, lambda place: write_whole(place, _ioh(arenas))


def _ioh(arenas: Sequence[Arena]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_COLUMNS)
    for arena in arenas:
        size = arena.yardstick.front.profile.size
        for field in arena.own:
            for number, missing in enumerate(field.missing.tolist(), start=1):
                for evaluations, share in zip(field.evaluations.tolist(), missing, strict=True):
                    writer.writerow([evaluations, share, arena.problem, field.method, size, number])
    return text.getvalue()


def coco_files(folder: Path | None, arenas: Sequence[Arena]) -> list[File]:
    """Archives as those of COCO's bi-objective suites, a file a problem; none without a folder.

    Each has the extremes of the exact front, then the motions that no other of any run dominates:
    evaluations of the whole run (when in it a motion was found is not kept), residual [m], energy
    [J] and coefficients.
    """
    if folder is None:
        return []
    folder.mkdir(parents=True, exist_ok=True)
    names = {name: number for number, name in enumerate(PROBLEMS, start=1)}
    files = list[File]()
    for number, arena in enumerate(arenas, start=len(names) + 1):
        function = names.get(arena.problem, number)
        size = arena.yardstick.front.profile.size
        name = f"quietarm_f{function:02d}_i01_d{size:02d}_nondominated.adat"
        text = _archive(arena)
        files.append((folder / name, lambda place, text=text: write_whole(place, text)))
    return files


def _archive(arena: Arena) -> str:
    found = [
        (run.front.evaluations or 0, point)
        for field in arena.fields
        for run in field.runs
        for point in run.front.points
    ]
    points = np.array([(point.residual, point.energy) for _, point in found]).reshape(-1, 2)
    kept = moocore.is_nondominated(points) if len(points) else []
    exact = arena.yardstick.front.points
    rows = [(0, exact[0]), (0, exact[-1])]
    rows += [one for one, keep in zip(found, kept, strict=True) if keep]
    lines = [f"% {arena.problem}", "% instance = 1", "%"]
    lines += [
        "\t".join(map(repr, [evaluations, point.residual, point.energy, *point.coefficients]))
        for evaluations, point in rows
    ]
    return "\n".join(lines) + "\n"
