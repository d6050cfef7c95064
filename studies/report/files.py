"""Documents in a folder."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from quietarm.ocp.base.files import write_whole
from quietarm.studies.display.saving import File, drawing, inside
from quietarm.studies.report.document import Document
from quietarm.studies.report.markdown import markdown

REPORT = "report.md"


def document_files(folder: Path, document: Document) -> list[File]:
    """The report, a CSV file for each table of its data, and its pictures; what writes each."""
    writes: dict[str, Callable[[Path], object]] = {
        REPORT: lambda path: write_whole(path, markdown(document))
    }
    writes |= {f"{name}.csv": table.save_csv for name, table in document.data.items()}
    writes |= {picture.name: drawing(picture.draw) for picture in document.pictures}
    return inside(folder, writes)
