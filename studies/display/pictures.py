"""Pictures, written whole or not at all."""

from __future__ import annotations

import io
from pathlib import Path

from matplotlib.figure import Figure

from ocp.base.files import write_whole
from studies.display.picture_names import check_figure


def save_figure(figure: Figure, path: str | Path) -> None:
    """Write a picture whole or not at all.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        The picture.
    path : str or Path
        The file; its ending, .png, .pdf or .svg, says the format.

    Raises
    ------
    ValueError
        When the file cannot be written or its ending is unknown.
    """
    target = check_figure(path)
    content = io.BytesIO()
    figure.savefig(content, format=target.suffix[1:].lower(), dpi=150)
    write_whole(target, content.getvalue())
