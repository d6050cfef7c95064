"""What a study writes: its page, and the fronts it found."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

from quietarm.ocp.base.files import write_whole
from quietarm.studies.display.saving import File, inside
from quietarm.studies.display.words import title_of
from quietarm.studies.study.page import study_page
from quietarm.studies.study.work import Study


def page_file(study: Study, output: Path) -> File:
    """The page of a study, and what writes it."""
    return output, lambda path: write_whole(path, study_page(study))


def front_files(study: Study, folder: Path) -> list[File]:
    """Every front of a study, which `quietarm compare` reads, in a folder, and what writes it."""
    writes: dict[str, Callable[[Path], object]] = {}
    for found in study.cases:
        for run in found.comparison.runs:
            seed = "" if run.front.seed is None else f"-seed{run.front.seed}"
            name = f"{title_of(found.case.task)}-{run.front.method}{seed}"
            writes[f"{_file_name(name)}.json"] = run.front.save
    return inside(folder, writes)


def _file_name(words: str) -> str:
    signed = re.sub(r"(?<!\w)-", "minus-", words)
    return re.sub(r"[^A-Za-z0-9.]+", "-", signed)
