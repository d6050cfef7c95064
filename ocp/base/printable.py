"""Make texts from outside, such as names of files, safe to print on a terminal."""

from __future__ import annotations

from unicodedata import category

_OBEYED = ("Cc", "Cf", "Cs", "Zl", "Zp")
"""Categories of what is obeyed: control characters, those that turn the direction of the text or
cannot be seen, other ends of lines, and bytes that are no characters, which no file can hold."""


def has_control_characters(text: str) -> bool:
    """Whether a text holds any character that a terminal obeys instead of showing it."""
    return not text.isprintable() and any(category(c) in _OBEYED for c in text)


def printable(text: str) -> str:
    """A text whose control characters are spelled out."""
    control = {c: c.encode("unicode_escape").decode() for c in text if category(c) in _OBEYED}
    return text.translate(str.maketrans(control))
