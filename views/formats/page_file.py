"""The page on which one drags along a front, or sees a plan move: one file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from quietarm.views.formats.export_format import (
    FRONT,
    PLAN,
    SEVERAL,
    Answers,
    Exported,
    ExportFormat,
    ExportSetting,
    Progress,
)
from quietarm.views.formats.film_files import DEFLECTION_SCALE
from quietarm.views.report.words import counted


class PageFile(ExportFormat):
    """A page: one drags along the first front of a move; other answers lie beside it."""

    name = "html"
    endings = (".html", ".htm")
    meaning = "a page with the motions"
    takes = (PLAN, FRONT, SEVERAL)
    settings = (
        DEFLECTION_SCALE,
        ExportSetting(
            "known_points", None, "Points that are known of a task's fronts.", kind=object
        ),
    )

    def export(self, answers: Answers, path: Path, report: Progress, **settings: Any) -> Exported:
        """The page; how many motions it has, and how large it is."""
        from quietarm.views.page.trade_off import trade_off  # matplotlib is slow to load

        page = trade_off(answers, **settings)
        content = page.html()
        motions = counted(sum(len(move["points"]) for move in page.moves), "motion")
        size = f"{len(content.encode()) / 1e3:.0f} kB"
        return Exported({path: content}, [f"{motions}, {size}"])
