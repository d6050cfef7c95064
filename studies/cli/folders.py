"""Make sure before the work that files can be written in a folder."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from quietarm.ocp.files import check_writable


def check_folder(path: str | Path) -> Path:
    """Make sure that files can be written in a folder, or that it can be made."""
    folder = Path(path)
    if folder.is_dir():
        check_writable(folder / "any")
    elif folder.exists():
        raise ValueError(f"{folder} is a file; give a folder")
    else:
        check_writable(folder)
    return folder


def check_inside(folder: Path, places: Sequence[Path]) -> None:
    """Make sure that files can be written at several places inside a folder, deep ones too."""
    parts = {part for place in places for part in place.relative_to(folder).parents}
    for inner in (folder, *(folder / part for part in sorted(parts))):
        if os.path.lexists(inner):
            check_folder(inner)
    for place in places:
        if os.path.lexists(place):
            check_writable(place)
