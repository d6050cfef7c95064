"""No two classes have one name, so that a name says which is meant."""

import ast
from collections import Counter
from pathlib import Path

import quietarm

ROOMS = ("models", "ocp", "metaheuristics", "machine", "views", "studies")
SHARED = {"Body", "Columns"}
"""Of models alone, and of machine alone."""


def classes():
    """The names of all classes of quietarm."""
    for room in ROOMS:
        folder = next(
            Path(place, room) for place in quietarm.__path__ if Path(place, room).is_dir()
        )
        for file in folder.rglob("*.py"):
            tree = ast.parse(file.read_text())
            yield from (node.name for node in ast.walk(tree) if isinstance(node, ast.ClassDef))


def test_no_two_classes_have_one_name():
    counts = Counter(classes())
    assert len(counts) > 200  # they were read
    assert {name for name, count in counts.items() if count > 1} <= SHARED
