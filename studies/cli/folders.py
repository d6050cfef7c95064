"""Make sure before the work that files can be written in a folder."""

from __future__ import annotations

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
