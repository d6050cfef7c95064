"""Check that the file of a run belongs to a job, by the digest of the job that it names."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from quietarm.metaheuristics.evaluation.stated_figures import check_figures
from quietarm.metaheuristics.score import objectives
from quietarm.ocp import Front

if TYPE_CHECKING:
    from quietarm.metaheuristics.jobs import Job

JOB = "job"
"""The setting of a run's record that has the digest of its job."""
BESIDE_SETTINGS = frozenset({JOB, "checksum"})
"""Settings of a run's record that are none of its method: the digest, and that of 2.0.0."""


def digest_of_job(job: Job) -> str:
    """A digest of what was asked for, and of the reference front as the scale of its figures.

    That the entries are those that were written, the checksum of any answer's file says.
    """
    return _digest([job.name, _scale_of(job)])


def check_run(front: Front, job: Job, path: Path) -> None:
    """Refuse a file that does not hold what a bench wrote for a job.

    That it is as it was written, its checksum says. A run of 2.0.0 has no such digest of its job:
    what it says of that is compared, and some of its motions are evaluated again.
    """
    remedy = "delete that file, and its run is done again"
    settings = front.record.settings
    if JOB in settings:
        if settings[JOB] != digest_of_job(job):
            raise ValueError(
                f"{path} is not what a bench wrote for {job.label}, seed {job.seed}: it is another "
                f"run's, or was measured against another reference front; {remedy}"
            )
        return
    check_figures(front, str(path), remedy=remedy)
    if difference := _different_job(front, job):
        raise ValueError(f"{path} {difference}; {remedy}")


def _scale_of(job: Job) -> list[list[float]]:
    return objectives(job.problem.reference().front).tolist()


def _digest(content: list[Any]) -> str:
    text = json.dumps(content, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def _different_job(front: Front, job: Job) -> str:
    """Say which method, seed, setting or budget of a file is not the job's."""
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
