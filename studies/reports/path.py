"""A recorded path on the screen: what the joint's motion costs and leaves."""

from __future__ import annotations

import numpy as np
from quietarm.ocp import Candidate, PointToPoint
from quietarm.studies.display.words import millimetres
from quietarm.studies.document.blocks import Document, Facts
from quietarm.studies.reading.path import RecordedPath
from quietarm.studies.reports.plan import figure_rows, move_rows


def evaluated_path(task: PointToPoint, path: RecordedPath) -> Document:
    """Figures by CVODES; of an uncertain plant also at the corners of its errors."""
    free = path.motion
    candidate = Candidate.of_free_motion(task.certain, free)
    motion = candidate.motion
    ends = (f"{1e3 * gap:.3g}" for gap in (free.lengths.min(), free.lengths.max()))
    gaps = " to ".join(dict.fromkeys(ends))
    jump = np.abs(np.diff(free.acceleration)).max(initial=0.0)
    rows = [
        *move_rows(task, motion),
        ("path", f"{free.steps + 1} points, {gaps} ms apart"),
        ("smoothness", f"acceleration changes by up to {jump:.3g} rad/s^2 from point to point"),
        ("energy (F2)", f"{motion.energy:.6g} J  (net work {motion.net_work:.4g} J)"),
        *figure_rows(task, motion),
    ]
    for scenario in task.scenarios[1:]:
        errors = dict(zip(task.error_names, scenario, strict=True))
        words = ", ".join(f"{name} {100 * error:+.3g} %" for name, error in errors.items())
        left = candidate.perturbed(errors).residual
        rows.append(("residual", f"{millimetres(left)} with {words}"))
    rows.append(("verified", "by CVODES alone, along the spline"))
    return Document("", [Facts(rows)])
