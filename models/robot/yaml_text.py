"""YAML with plain numbers, within bounds: what a stranger's file says is read in seconds.

Numbers are those of YAML 1.2: a colon, a date or a prefix makes a text. Every name stands once,
and nothing in a file is run.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import yaml

from quietarm.models.number_checks import clipped, quoted

MOST_BYTES = 3_000_000
"""Of a text: a trajectory of ten thousand points, some ten seconds of reading."""
MOST_ENTRIES = 1_000_000
"""Of a document, where an alias counts as what it repeats."""
DEEPEST = 50
"""So many levels stand in one another; a robot's file has four."""
_TAG = "tag:yaml.org,2002:"
_SCALARS = {
    "null": (r"~|null|Null|NULL|", ["~", "n", "N", ""]),
    "bool": (
        r"(?:true|false|yes|no|on|off|True|False|Yes|No|On|Off|TRUE|FALSE|YES|NO|ON|OFF)",
        list("tfynoTFYNO"),
    ),
    "int": (r"[-+]?[0-9]{1,18}", list("-+0123456789")),
    "float": (
        r"[-+]?(?:\.[0-9]{1,400}|[0-9]{1,400}(?:\.[0-9]{0,400})?)(?:[eE][-+]?[0-9]{1,9})?"
        r"|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)",
        list("-+.0123456789"),
    ),
    "merge": ("<<", ["<"]),
}
"""What a text without quotation marks may be but a text: its form, and its first letters."""


def parse_yaml(text: str) -> object:
    """Parse a YAML text of one document; ValueError if it is none, or out of bounds."""
    if len(text.encode()) > MOST_BYTES:
        raise ValueError(f"has over {MOST_BYTES} bytes; give a smaller part, or a csv")
    loader = _loader_class()(text)
    try:
        _check_depth(text)
        documents = list(_documents(loader))
        if len(documents) > 1:
            raise ValueError(f"has {len(documents)} documents; give one")
        return documents[0] if documents else None
    except yaml.YAMLError as error:
        raise ValueError(f"is no valid YAML: {_words_of(error)}; mend it") from None
    finally:
        loader.dispose()


def _documents(loader: Any) -> Iterator[object]:
    """The documents, without an empty one after the last `---`, as `ros2 topic echo` ends."""
    begun = False
    while loader.check_node():
        node = loader.get_node()
        _check_entries(node, {})
        document = loader.construct_document(node)
        if document is not None or not begun:
            begun = True
            yield document


def _words_of(error: yaml.YAMLError) -> str:
    """Say what is wrong and where, without quoting the text there."""
    problem = clipped(str(getattr(error, "problem", None) or "it cannot be read"))
    mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
    return problem if mark is None else f"{problem} in line {mark.line + 1}"


def _check_depth(text: str) -> None:
    """Refuse what is nested deep, before it is composed one level within the other."""
    depth = 0
    for event in yaml.parse(text, Loader=_base()):
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
        if depth > DEEPEST:
            raise ValueError("is nested too deeply; write it flat")


def _check_entries(node: yaml.Node, counted: dict[int, int]) -> int:
    """Count the values of a node, an alias wherever it stands; refuse names that come twice."""
    if isinstance(node, yaml.ScalarNode):
        return 1
    if id(node) not in counted:
        counted[id(node)] = MOST_ENTRIES + 1  # until it is known: of what holds itself
        inner = node.value
        if isinstance(node, yaml.MappingNode):
            _refuse_repeated(node)
            inner = [part for pair in node.value for part in pair]
        counted[id(node)] = 1 + sum(_check_entries(part, counted) for part in inner)
        if counted[id(node)] > MOST_ENTRIES:
            raise ValueError(f"repeats its aliases to over {MOST_ENTRIES} entries; write them out")
    return counted[id(node)]


def _refuse_repeated(table: yaml.MappingNode) -> None:
    """Refuse a table in which a name comes twice: of two values one would be passed over."""
    names = set[tuple[str, str]]()
    for key, _ in table.value:
        if not isinstance(key, yaml.ScalarNode):
            raise ValueError("has a table or a list for a name; give names")
        if (key.tag, key.value) in names:
            line = key.start_mark.line + 1
            raise ValueError(f"has {quoted(key.value)} twice, again in line {line}; give it once")
        names.add((key.tag, key.value))


def _base() -> Any:
    """The loader of libyaml, some times as fast, where PyYAML was built with it."""
    return getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@lru_cache(maxsize=1)
def _loader_class() -> Any:
    """A loader that makes texts, numbers, truth values, lists and tables, and nothing else."""

    class PlainLoader(_base()):
        yaml_implicit_resolvers: dict[Any, Any] = {}  # noqa: RUF012  # of PyYAML's own making
        yaml_constructors = {
            f"{_TAG}{kind}": _base().yaml_constructors[f"{_TAG}{kind}"]
            for kind in ("null", "str", "seq", "map")
        } | {None: _base().yaml_constructors[None]}

    for kind, (form, first) in _SCALARS.items():
        PlainLoader.add_implicit_resolver(f"{_TAG}{kind}", re.compile(rf"(?:{form})\Z"), first)
    for kind, make in {"bool": _truth, "int": int, "float": _real}.items():
        PlainLoader.add_constructor(f"{_TAG}{kind}", _scalar_of(kind, make))
    return PlainLoader


def _scalar_of(kind: str, make: Any) -> Any:
    """Return the constructor of a scalar, which also checks one that a tag declares."""
    form = re.compile(rf"(?:{_SCALARS[kind][0]})\Z")

    def construct(loader: Any, node: yaml.ScalarNode) -> object:
        text = loader.construct_scalar(node)
        if not form.match(text):
            raise ValueError(f"has a value that is none: {quoted(text)} as {kind}; mend it")
        return make(text)

    return construct


def _truth(text: str) -> bool:
    """A truth value, as people and robots write it."""
    return text.lower() in ("true", "yes", "on")


def _real(text: str) -> float:
    """A real number, .inf and .nan among them."""
    return float(re.sub(r"\.(?=[iInN])", "", text))
