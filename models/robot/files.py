"""Small files of text that a robot is read from."""

from __future__ import annotations

import reprlib
from functools import cache
from pathlib import Path
from typing import Any

from quietarm.models.checks import install

MOST_BYTES = 20_000_000
"""Of a file: URDFs have a few hundred thousand."""
MOST_ENTRIES = 1_000_000
"""Of a file in YAML, where an alias counts as what it repeats."""


def read_text(path: str | Path, what: str) -> str:
    """The text of an ordinary file in UTF-8; ValueError where it cannot be read."""
    place = Path(path)
    try:
        if place.exists() and not place.is_file():
            raise ValueError(f"{what} {path} is no ordinary file; give the name of one")
        with open(place, "rb") as file:
            content = file.read(MOST_BYTES + 1)
        if len(content) > MOST_BYTES:
            raise ValueError(f"{what} {path} has over {MOST_BYTES} bytes; is it another file?")
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"{what} {path} is no text in UTF-8; save it so") from None
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise ValueError(f"{what} {path} cannot be read: {reason}; give another file") from None


def read_yaml(path: str | Path, what: str) -> object:
    """What a file in YAML holds; nothing in it is run."""
    text = read_text(path, what)
    try:
        import yaml
    except ImportError:
        raise ValueError(f"{what} {path} is YAML, which needs PyYAML; {install('robot')}") from None
    try:
        document = _only(list(yaml.load_all(text, Loader=_loader())))
        entries = _entries(document, {})
    except _TwiceError as error:
        raise ValueError(f"{what} {path} {error}") from None
    except yaml.YAMLError as error:
        raise ValueError(
            f"{what} {path} is no valid YAML: {' '.join(str(error).split())}; mend it"
        ) from None
    except RecursionError:
        raise ValueError(f"{what} {path} is nested too deeply; write it flat") from None
    # of what its tags and dates are made of
    except (ValueError, TypeError, AttributeError, LookupError, OverflowError) as error:
        raise ValueError(f"{what} {path} has a value that is none: {error}; mend it") from None
    if entries > MOST_ENTRIES:
        raise ValueError(
            f"{what} {path} repeats its aliases to over {MOST_ENTRIES} entries; write them out"
        )
    return document


class _TwiceError(Exception):
    """What a file has twice and may have once."""


def _only(documents: list[object]) -> object:
    """The only document of a stream, which `ros2 topic echo` ends with dashes."""
    filled = [document for document in documents if document is not None]
    if len(filled) > 1:
        raise _TwiceError(f"has {len(filled)} documents, separated by ---; leave one of them")
    return filled[0] if filled else None


@cache
def _loader() -> Any:
    """What reads YAML, runs nothing of it, and refuses an entry that a table has twice."""
    import yaml

    class Loader(yaml.SafeLoader):
        """YAML itself would keep the last of two entries of one name."""

        def compose_mapping_node(self, anchor: Any) -> Any:
            """A table, before its entries are merged with those of others."""
            node = super().compose_mapping_node(anchor)
            lines = dict[tuple[str, str], int]()
            for key, _ in node.value:
                if isinstance(key, yaml.ScalarNode):
                    line = key.start_mark.line + 1
                    entry = (key.tag, key.value)
                    if entry in lines:
                        raise _TwiceError(
                            f"has the entry {reprlib.repr(key.value)} twice, in lines "
                            f"{lines[entry]} and {line}; leave one of them"
                        )
                    lines[entry] = line
            return node

    return Loader


def _entries(value: object, counted: dict[int, int]) -> int:
    """How many values there are in one, an alias counted wherever it stands."""
    if not isinstance(value, dict | list):
        return 1
    if id(value) not in counted:
        counted[id(value)] = MOST_ENTRIES + 1  # until it is known: of what holds itself
        contents = value.values() if isinstance(value, dict) else value
        counted[id(value)] = 1 + sum(_entries(content, counted) for content in contents)
    return counted[id(value)]
