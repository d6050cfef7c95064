"""Types of options: quantities with units, names, files that are read or written."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import click

from quietarm.ocp.checks import spelling, unknown, with_article
from quietarm.studies.cli.quantities import parse_pair, parse_usual


class Parsed(click.ParamType):
    """A value read by a function that raises ValueError with a message for the user."""

    def __init__(self, name: str, parse: Callable[[str], Any]) -> None:
        self.name = name
        self.parse = parse

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Read the text; a click error names the option."""
        try:
            return self.parse(value)
        except ValueError as error:
            self.fail(str(error), param, ctx)


class Named(click.Choice):  # pyright: ignore[reportMissingTypeArgument]
    """One of several names; an error suggests the nearest one, or says why a name is none here.

    Large letters, hyphens and spaces do not matter: NSGA-II and nsga_2 are nsga2.
    """

    def __init__(
        self,
        what: str,
        names: Iterable[str] | Callable[[], Iterable[str]],
        none: Mapping[str, str] | None = None,
    ):
        self._list_names = names if callable(names) else partial(list[str], names)
        super().__init__(list(self._list_names()))
        self._what = what
        self._none = {spelling(name): why for name, why in (none or {}).items()}

    def get_metavar(self, param: click.Parameter, ctx: click.Context) -> str | None:
        """The names as a help shows them, or METHOD where they are too many for its line."""
        most = 60
        names = super().get_metavar(param, ctx) or ""
        return names if len(names) <= most else self._what.upper()

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The name."""
        self.choices = tuple(self._list_names())  # a user's own file may have brought more
        same = [name for name in self.choices if spelling(name) == spelling(value)]
        if not same:
            known = unknown(self._what, value, self.choices)
            self.fail(self._none.get(spelling(value), known), param, ctx)
        return same[0]


LENGTH, TIME, SHARE = (
    Parsed(name, partial(parse_usual, unit, with_article(name)))
    for name, unit in {"length": "m", "time": "s", "share": "-"}.items()
)
SETTING = Parsed("name=value", parse_pair)
NAMES = Parsed("names", lambda text: tuple(name.strip() for name in text.split(",")))
INPUT = click.Path(path_type=Path)
