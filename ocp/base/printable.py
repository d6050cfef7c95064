"""Make texts from outside, such as names of files, safe to print on a terminal."""

from __future__ import annotations

from unicodedata import category


def has_control_characters(text: str) -> bool:
    """Whether a text holds any character that a terminal obeys instead of showing it."""
    return any(category(character) == "Cc" for character in text)


def printable(text: str) -> str:
    """A text whose control characters are spelled out."""
    control = {c: c.encode("unicode_escape").decode() for c in text if category(c) == "Cc"}
    return text.translate(str.maketrans(control))
