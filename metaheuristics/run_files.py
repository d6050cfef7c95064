"""Whether the file of a run is what a bench wrote for that job: by its checksum, or evaluated."""

from __future__ import annotations

import hashlib
import json
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from quietarm.metaheuristics.algorithms.presets import PRESETS
from quietarm.metaheuristics.objective.stated_figures import check_figures
from quietarm.metaheuristics.score import HYPERVOLUME, filled, objectives
from quietarm.ocp import Front, Mark
from quietarm.ocp.saved import as_loaded, keeps_checksum, plain, read_document, stated_part

if TYPE_CHECKING:
    from quietarm.metaheuristics.jobs import Job

JOB = "job"
"""The setting of a run's record that has the digest of its job."""
CHECKSUM_BEFORE = "checksum"
"""The same of a run of before: a digest of its job and of all entries."""
SEALS = frozenset({JOB, CHECKSUM_BEFORE})


def digest_of_job(job: Job) -> str:
    """A digest of what was asked for, and of the reference front as the scale of its figures.

    That the entries are those that were written, the checksum of any answer's file says.
    """
    return _digest([job.name, _scale_of(job)])


def is_sealed(front: Front) -> bool:
    """Whether a run states for which job a bench wrote it; runs of before need not."""
    return not SEALS.isdisjoint(front.record.settings)


def check_run(front: Front, job: Job, path: Path) -> None:
    """ValueError where a file does not hold what a bench wrote for a job.

    A file that names no job, of before, is evaluated again: its motions, and what it states of
    its quality at the end. Its effort and what it says of the way there can only be consistent.
    """
    remedy = "delete that file, and its run is done again"
    if is_sealed(front):
        if not _is_as_written(front, job, path):
            raise ValueError(
                f"{path} is not what a bench wrote for {job.label}, seed {job.seed}: it was "
                "changed, is another run's, or was measured against another reference front; "
                f"{remedy}"
            )
        return
    check_figures(front, str(path), remedy=remedy)
    difference = _different_job(front, job) or _different_end(front, job) or _disorder(front, job)
    if difference:
        raise ValueError(f"{path} {difference}; {remedy}")


def _is_as_written(front: Front, job: Job, path: Path) -> bool:
    """Whether a file holds all that a bench wrote for a job, and nothing else."""
    settings = front.record.settings
    if JOB in settings:
        return settings[JOB] == digest_of_job(job) and bool(keeps_checksum(path, Front.kind))
    return settings[CHECKSUM_BEFORE] == _checksum_before(front, job, path)


def _checksum_before(front: Front, job: Job, path: Path) -> str:
    """The digest of a run of before: of all that its file says but the checksum itself.

    What is newer than the file, and which it does not state, is no part of it.
    """
    settings = front.record.settings.items()
    stated_settings = {name: value for name, value in settings if name != CHECKSUM_BEFORE}
    loaded = as_loaded(front.restated(settings=stated_settings))
    stated = stated_part(plain(loaded, whole=True), read_document(path, Front.kind))
    return _digest([job.name, _scale_of(job), stated])


def _scale_of(job: Job) -> list[list[float]]:
    return objectives(job.problem.reference().front).tolist()


def _digest(content: list[Any]) -> str:
    text = json.dumps(content, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def _different_job(front: Front, job: Job) -> str:
    """What a file says of method, seed, settings and budget that is not the job's."""
    stated = {
        "method": front.record.method,
        "seed": front.record.seed,
        **front.record.settings,
    }
    wanted = {
        "seed": job.seed,
        "problem": job.problem.name,
        # multistart states its starts as points: each of them is one start
        **{"points" if name == "starts" else name: job.settings[name] for name in job.settings},
    }
    if isinstance(job.method, str):  # of one's own the digest of the method tells
        wanted["method"] = job.method
    if job.budget is not None:
        wanted["budget"] = job.budget
    for name, value in wanted.items():
        if stated.get(name) != value:
            return f"states {name} {stated.get(name)}, and its job has {value}"
    return ""


def _different_end(front: Front, job: Job) -> str:
    """What the last mark says of its points that is not so; a mark of today says nothing."""
    # those of one front differ by less: it is evaluated with the versions that wrote it
    tolerated = 1e-4
    if not front.history:
        return "says nothing of its cost"
    last = front.history[-1]
    scale = job.problem.reference()
    for what, quality, points in (
        ("its points", last.quality, objectives),
        ("its points with motions between", last.between, filled),
    ):
        if quality is None:
            continue
        share = scale.score(points(front), HYPERVOLUME)
        if not abs(quality.hypervolume - share) <= tolerated:
            return (
                f"states a hypervolume of {quality.hypervolume:.4f} for {what}, and they have "
                f"{share:.4f}"
            )
    return ""


def _disorder(front: Front, job: Job) -> str:
    """What cannot be of the effort that a file states."""
    first = Mark(0)
    for before, after in pairwise((first, *front.history)):
        for name in ("evaluations", "seconds", "gradients", "hessians"):
            if getattr(after, name) < getattr(before, name):
                return f"states a history in which {name} fall"
    last = front.history[-1]
    record = front.record
    if last.evaluations != record.evaluations or last.seconds > record.seconds:
        return (
            f"states {record.evaluations} candidates in {record.seconds:.3g} s, and its history "
            f"ends with {last.evaluations} in {last.seconds:.3g} s"
        )
    preset = PRESETS.get(job.method) if isinstance(job.method, str) else None
    if preset is not None and preset.own is None and last.evaluations != job.budget:
        return f"states {last.evaluations} candidates, and its job has a budget of {job.budget}"
    return ""
