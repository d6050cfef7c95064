"""Numbers in the text of a notebook, and what it prints, or is given, that they come from."""

import re
import tomllib
from pathlib import Path

from notebook_files import printed, solutions

STATED = Path(__file__).parents[1] / "notebooks" / "stated.toml"
"""Numbers of texts that no output shows, by notebook, each with where it comes from."""

NO_CLAIM = re.compile(
    r"```.*?```"  # programs, and what they print
    r"|`[^`]*`"
    r"|\$\$.*?\$\$|\$[^$]*\$"  # equations
    r"|\]\([^)]*\)"  # addresses
    r"|^#[^\n]*|^(?:\*\*)?\d\. |^\|[^\n]*"  # headings, the numbers of lists, tables
    r"|[Nn]otebooks? \d\w*(?:(?:, | and | to )\d\d\w?)*"
    r"|\b\d\d[ab]\b"
    r"|\b(?:[Ee]xercises?|Tables?|refs?\.|eqs?) [\d(][\d(), ]*(?:(?: and | to )[\d(]\d*\)?)*"
    r"|\(\d+\)|\[\d+(?:, \d+)*\]"  # equations and references
    r"|quietarm\.\w+|<[^>]*>",
    re.DOTALL | re.MULTILINE,
)
"""What of a text says nothing about an output."""
NUMBER = re.compile(r"(?<![\w.,])[-\u2212]?\d[\d,]*(?:\.\d+)?(?![\w.]*\d)")
IN_PRINT = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
BESIDE = 3
"""Outputs before a text that it speaks of."""
SUMMARY = "## What you saw"
"""How the last text begins, which speaks of all outputs."""
SHARE_OF_PI = re.compile(r"\bpi / (\d+)")
SCALES = (1.0, 1e2, 1e3, 1e6)
"""From the SI units of programs to per cent, centimetres, millimetres and micrometres."""


def numbers_of(text):
    """The numbers that a text states, as they are written."""
    return NUMBER.findall(NO_CLAIM.sub(" ", text))


def unsupported(notebook, stated=()):
    """The numbers of a notebook's text without a source, and those that are stated needlessly.

    A source is one of the last outputs, or a program up to the one that follows the text; of the
    summary at the end every output.
    """
    given = set[float]()
    outputs, missing = list[set[float]](), list[str]()
    for cell, following in zip(notebook.cells, [*notebook.cells[1:], None]):
        for program in _programs(cell, following):
            given |= _values(program) | {180 / int(n) for n in SHARE_OF_PI.findall(program)}
        if cell.cell_type == "code":
            outputs += filter(None, [_values(printed(cell))])
            continue
        of_solutions = [_values(solution["shown"]) for solution in solutions(cell)]
        of_cells = outputs if cell.source.startswith(SUMMARY) else outputs[-BESIDE:]
        shown = set[float]().union(*of_cells, *of_solutions)
        missing += [
            text for text in numbers_of(cell.source)
            if not (_is_shown(text, shown) or _is_given(text, given))
        ]  # fmt: skip
    needless = set(stated) - set(missing)
    return [text for text in missing if text not in stated], sorted(needless)


def stated_in(path):
    """The numbers of a notebook that come from elsewhere, with where from."""
    return tomllib.loads(STATED.read_text(encoding="utf-8")).get(path.stem, {})


def _programs(cell, following):
    """Return what is computed in a cell, its solutions, and the cell that follows a text."""
    own = [cell.source] if cell.cell_type == "code" else []
    solved = [solution["code"] for solution in solutions(cell)]
    announced = [following.source] if following and following.cell_type == "code" else []
    return own + solved + announced


def _values(text):
    return {float(number) for number in IN_PRINT.findall(text.replace("_", ""))}


def _plain(text):
    return text.replace(",", "").replace("\u2212", "-")


def _is_shown(text, shown):
    """Return whether an output, rounded to the digits of the text, is that number."""
    value = float(_plain(text))
    decimals = len(_plain(text).partition(".")[2])
    return any(abs(abs(number) - abs(value)) <= 0.5000001 * 10.0**-decimals for number in shown)


def _is_given(text, given):
    """Return whether a program has that number, maybe in another unit."""
    value = abs(float(_plain(text)))
    return any(abs(value - scale * number) <= 1e-9 * value for number in given for scale in SCALES)
