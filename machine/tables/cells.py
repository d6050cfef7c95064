"""Cells of a text as numbers: decimal marks, thousands separators, times of a clock."""

from __future__ import annotations

import re
from typing import Any

_GROUPED = re.compile(r"(?<=\d)[ '\u2019_\u00a0\u202f](?=\d{3}(?!\d))")
"""A mark between three digits that is no decimal mark of any country."""
_NUMBER = re.compile(
    r"[+-]?(?:\d{1,3}(?:,\d{3})+(?:\.\d*)?|\d{1,3}(?:\.\d{3})+(?:,\d*)?|\d+[.,]?\d*|[.,]\d+)"
    r"(?:[eE][+-]?\d+)?"
)
_THOUSANDS = {mark: rf"[+-]?[1-9]\d{{0,2}}(?:\{mark}\d{{3}})+" for mark in ".,"}
"""Whole numbers whose digits a mark groups."""
_CLOCK = re.compile(
    r"(?:\d{1,4}[-/.]\d{1,2}[-/.]\d{1,4}[T ]\s*)?"
    r"(?:(?P<hours>\d{1,2}):)?(?P<minutes>\d{1,2}):(?P<seconds>\d{1,2}(?:[.,:]\d+)?)"
    r"\s*(?P<half>[AaPp]\.?[Mm]\.?)?\s*(?:Z|UTC|[+-]\d{2}:?\d{2})?"
)
"""A time of day, with or without a date, or minutes and seconds."""


def is_number(cell: str) -> bool:
    """Return whether a cell is a number, with any decimal mark and thousands separator."""
    no_numbers = ("nan", "inf", "infinity")
    plain = _GROUPED.sub("", cell)
    return bool(_NUMBER.fullmatch(plain)) or plain.lstrip("+-").lower() in no_numbers


def is_clock(cell: str) -> bool:
    """Return whether a cell is a time of a clock, such as 05:06:07.25, after a date or not."""
    return bool(_CLOCK.fullmatch(cell.strip()))


def numbers_of(cells: Any) -> Any:
    """The numbers of a table of texts (of pandas), not a number where a text is none.

    One decimal mark holds for the whole table.
    """
    import pandas as pd  # not at the top: it takes half a second to load

    to_numeric: Any = pd.to_numeric
    numbers = cells.apply(to_numeric, errors="coerce")
    odd = cells.where(cells.notna() & numbers.isna()).stack().dropna()
    if odd.empty:
        return numbers
    odd = odd.astype(str).str.replace(_GROUPED, "", regex=True)
    texts = cells.stack().dropna().astype(str).str.replace(_GROUPED, "", regex=True)
    thousands = _thousands_mark(texts)
    if thousands:
        plain = texts.where(texts.str.fullmatch(_NUMBER), "").str.replace(thousands, "")
        plain = plain.str.replace(",", ".")
        return to_numeric(plain, errors="coerce").unstack().reindex_like(numbers)
    plain = to_numeric(odd.str.replace(",", "."), errors="coerce").unstack()
    return numbers.combine_first(plain.reindex_like(numbers))


def _thousands_mark(cells: Any) -> str:
    """The mark that groups the thousands of a column's cells; empty where none does.

    Where a cell has both marks it is the first of them, and where one has a mark twice it is that.
    A mark alone in a cell groups thousands where it always stands before three digits, and other
    cells have no mark and are smaller, or have the other mark and not before three digits.
    """
    marked = cells[cells.str.contains("[.,]")]
    marked = marked[marked.str.fullmatch(_NUMBER)]
    both = marked[marked.str.contains(",", regex=False) & marked.str.contains(".", regex=False)]
    if len(both):
        return min(",.", key=both.iloc[0].index)
    for mark, decimal in (",.", ".,"):
        with_mark = marked[marked.str.contains(mark, regex=False)]
        if not len(with_mark):
            continue
        if with_mark.str.count(re.escape(mark)).max() > 1:
            return mark
        if not with_mark.str.fullmatch(_THOUSANDS[mark]).all():
            continue
        with_decimal = marked[marked.str.contains(decimal, regex=False)]
        if len(with_decimal) and not with_decimal.str.fullmatch(_THOUSANDS[decimal]).all():
            return mark
        whole = cells[cells.str.fullmatch(r"[+-]?\d+")]
        if mark == "," and not len(with_decimal) and len(whole) and whole.str.len().max() <= 4:
            return mark
    return ""


def seconds_of(cells: Any) -> Any:
    """Seconds since the first of a column's times (of pandas); midnight is passed, not a date."""
    half_a_day = 43_200.0
    import pandas as pd  # not at the top: it takes half a second to load

    to_numeric: Any = pd.to_numeric
    parts = cells.str.strip().str.extract(f"^{_CLOCK.pattern}$")
    numbers = parts[["hours", "minutes"]].apply(to_numeric)
    seconds = to_numeric(parts["seconds"].str.replace(r"[,:]", ".", regex=True))
    late = parts["half"].str.lower().str.startswith("p", na=False).astype(bool)
    hours = numbers["hours"].fillna(0).where(parts["half"].isna(), numbers["hours"] % 12)
    time = 3600 * (hours + 12 * late) + 60 * numbers["minutes"] + seconds
    known = time.dropna()
    midnights = (known.diff() < -half_a_day).cumsum()
    return (time + 2 * half_a_day * midnights.reindex(time.index).ffill()) - known.iloc[0]
