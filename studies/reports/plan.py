"""Until explore has `quietarm.studies.report.moves`: a plan as a document."""

from __future__ import annotations

from collections.abc import Sequence

from quietarm.ocp import Plan
from quietarm.studies.document.blocks import Document, Facts, Lines
from quietarm.studies.report.moves import HARD_REMEDY as HARD_REMEDY
from quietarm.studies.report.moves import plan_rows


def plan_document(plan: Plan, notes: Sequence[str] = ()) -> Document:
    """A plan's rows."""
    return Document("", [Facts(plan_rows(plan)), Lines(notes)])
