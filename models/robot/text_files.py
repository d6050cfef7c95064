"""Small files of text that a robot is read from."""

from __future__ import annotations

from pathlib import Path

from quietarm.models.number_checks import clipped, install

MOST_BYTES = 20_000_000
"""Of a file: URDFs have a few hundred thousand."""


def read_text(path: str | Path, what: str) -> str:
    """The text of an ordinary file in UTF-8; ValueError where it cannot be read."""
    place = Path(path)
    shown = clipped(str(path))  # a robot's file names it, or who types the command
    try:
        if place.exists() and not place.is_file():
            raise ValueError(f"{what} {shown} is no ordinary file; give the name of one")
        with open(place, "rb") as file:
            content = file.read(MOST_BYTES + 1)
        if len(content) > MOST_BYTES:
            raise ValueError(f"{what} {shown} has over {MOST_BYTES} bytes; is it another file?")
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"{what} {shown} is no text in UTF-8; save it so") from None
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise ValueError(f"{what} {shown} cannot be read: {reason}; give another file") from None


def read_yaml(path: str | Path, what: str) -> object:
    """Read the content of a YAML file; nothing in it is run."""
    text = read_text(path, what)
    try:
        from quietarm.models.robot.yaml_text import parse_yaml
    except ImportError:
        raise ValueError(
            f"{what} {clipped(str(path))} is YAML, which needs PyYAML; {install('robot')}"
        ) from None
    try:
        return parse_yaml(text)
    except ValueError as error:
        raise ValueError(f"{what} {clipped(str(path))} {error}") from None
