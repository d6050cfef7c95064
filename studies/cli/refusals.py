"""What click refuses, in the words of quietarm: the value and the remedy."""

from __future__ import annotations

import re

import click
from quietarm.ocp.base.names import nearest

_OF_CLICK = (
    (r"Got unexpected extra arguments? \((.*)\)",
     "{0!r} is more than {command} takes; leave it out"),
    (r"Option '(.*)' requires an argument\.", "{0} has no value; give one behind it"),
    (r"Option '(.*)' does not take a value\.", "{0} takes no value; give it alone"),
    (r"No such command '(.*)'\.", "unknown command {0!r}; {command} --help lists all"),
    (r"Missing command\.", "no command is given; {command} --help lists them"),
)  # fmt: skip
"""click's sentences that no class of error stands for, and ours."""


def in_our_words(error: click.ClickException) -> str:
    """What to say of bad usage, in one line."""
    context = getattr(error, "ctx", None)
    command = context.command_path if context else "quietarm"
    if isinstance(error, click.NoSuchOption):
        return _unknown_option(error, context, command)
    if isinstance(error, click.MissingParameter):
        return _missing(error.param, context)
    if isinstance(error, click.BadParameter):
        return f"{_name(error.param, context)}: {error.message}" if error.param else error.message
    said = error.format_message()
    for theirs, ours in _OF_CLICK:
        found = re.fullmatch(theirs, said, re.DOTALL)
        if found:
            return ours.format(*found.groups(), command=command)
    return said


def _unknown_option(error: click.NoSuchOption, context: click.Context | None, command: str) -> str:
    known = [name for one in context.command.params for name in one.opts] if context else []
    question = nearest(error.option_name, [name for name in known if name.startswith("--")])
    return f"{command} has no option {error.option_name!r}; {question}{command} --help lists all"


def _missing(parameter: click.Parameter | None, context: click.Context | None) -> str:
    name = _name(parameter, context)
    if context is None or not isinstance(parameter, click.Option):
        usage = context.get_usage().removeprefix("Usage: ") if context else name
        return f"{name} is missing; give it, as {usage}"
    kinds = parameter.type
    names = kinds.choices if isinstance(kinds, click.Choice) else [parameter.make_metavar(context)]
    return f"{name} is missing; give it, as {name} {' or '.join(map(str, names))}"


def _name(parameter: click.Parameter | None, context: click.Context | None) -> str:
    """What a parameter is called in the help of its command."""
    if isinstance(parameter, click.Option):
        return parameter.opts[-1]
    return parameter.make_metavar(context).strip("[]. ") if parameter and context else "an argument"
