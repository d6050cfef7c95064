"""What a study writes: its page, and the fronts it found."""

from __future__ import annotations

import re
from pathlib import Path

from ocp.base.files import check_writable, write_whole
from studies.paper.tasks import title_of
from studies.study.page import study_page
from studies.study.work import Study


def write_study(study: Study, output: Path, folder: Path | None = None) -> list[Path]:
    """Write the page, and every front to a folder; return what was written.

    Parameters
    ----------
    study : Study
        What was found.
    output : Path
        File of the page.
    folder : Path, optional
        Folder for the fronts, which `quietarm compare` reads.

    Returns
    -------
    list of Path
        The files, each whole.

    Raises
    ------
    ValueError
        When a file cannot be written.
    """
    content = study_page(study)
    written = [check_writable(output)]
    write_whole(output, content)
    if folder is not None:
        folder.mkdir(exist_ok=True)
        for found in study.cases:
            for run in found.comparison.runs:
                seed = "" if run.front.seed is None else f"-seed{run.front.seed}"
                name = f"{title_of(found.case.task)}-{run.front.method}{seed}"
                path = folder / f"{_file_name(name)}.json"
                run.front.save(path)
                written.append(path)
    return written


def _file_name(words: str) -> str:
    signed = re.sub(r"(?<!\w)-", "minus-", words)
    return re.sub(r"[^A-Za-z0-9.]+", "-", signed)
