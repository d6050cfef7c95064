"""The packages as a reader finds them: a name means one thing, and no files need each other."""

import ast
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGES = ("models", "ocp", "metaheuristics", "machine", "views", "studies")
TREES = {
    path.relative_to(ROOT): ast.parse(path.read_text(encoding="utf-8"))
    for package in PACKAGES
    for path in sorted((ROOT / package).rglob("*.py"))
}

FREE_OF_CIRCLES = ("models", "metaheuristics", "machine", "views")
FOR_TYPES_ALONE = {
    ("models.plant", "models.validation"),
    ("metaheuristics.jobs", "metaheuristics.run_files"),
}
"""Where a file is checked by the other one, which knows its type."""


def named_twice(named):
    """Names that stand for several things, from pairs of a name and where it is."""
    places = defaultdict(set)
    for name, place in named:
        places[name].add(str(place))
    return {name: sorted(where) for name, where in places.items() if len(where) > 1}


def test_no_two_modules_or_rooms_have_one_name():
    """But a room and the file in it from which it has its name, such as front/front.py."""
    rooms = {path.parent for path in TREES}
    files = [path for path in TREES if path.stem not in ("__init__", path.parent.name)]
    named = [(path.stem, path) for path in files] + [(room.name, room) for room in rooms]
    assert not named_twice(named)


def test_no_two_classes_have_one_name():
    named = [
        (node.name, path)
        for path, tree in TREES.items()
        for node in ast.walk(tree)
        if isinstance(node, ast.ClassDef)
    ]
    assert len(named) > 200
    assert not named_twice(named)


def module_of(path):
    """The name of a file's module, or of the room of which it is the front."""
    parts = path.with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {module_of(path): tree for path, tree in TREES.items()}


def imported(tree):
    """Modules of the packages that one imports anywhere: for types alone and late as well."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            module = node.module.removeprefix("quietarm.")
            names = [f"{module}.{entry.name}" for entry in node.names]
            found.update(name if name in MODULES else module for name in names)
    return found & MODULES.keys()


def reached(begin, needs):
    """Return what a module needs, and what these need."""
    seen = set()
    waiting = [*needs[begin]]
    while waiting:
        module = waiting.pop()
        if module not in seen:
            seen.add(module)
            waiting += needs[module]
    return seen


def test_no_files_need_each_other_not_even_for_a_type():
    needs = {name: imported(tree) for name, tree in MODULES.items()}
    everything = {name: reached(name, needs) for name in needs}
    mutual = {
        (one, other)
        for one in needs
        for other in everything[one]
        if one < other and one in everything[other] and one.startswith(FREE_OF_CIRCLES)
    }
    assert any(needs.values())
    assert mutual <= FOR_TYPES_ALONE


def test_no_class_has_the_name_of_a_type_that_is_written_elsewhere():
    """A type Values = Sequence[Expression] beside a class Values is taken for the other one."""
    classes = {
        node.name: path
        for path, tree in TREES.items()
        for node in ast.walk(tree)
        if isinstance(node, ast.ClassDef)
    }
    written = {
        (target.id, path)
        for path, tree in TREES.items()
        for node in tree.body
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Name) and not target.id.isupper()
    }
    assert written
    assert not [(name, path) for name, path in written if classes.get(name, path) != path]


READ_ALONE = ("models", "ocp", "metaheuristics", "machine", "views", "studies")
"""Rooms in which every docstring can be read alone; one more may be added once it can."""
HANGING = ("The same", "Those ", "That of", "As of", "Of ", "What ", "Whatever ", "Whether ",
           "How ", "By how", "Such ", "None of", "All that", "Its ", "Their ", "They ",
           "It ")  # fmt: skip
"""Words with which a sentence begins that says nothing without the one before it, or the code."""


def test_a_docstring_begins_with_a_verb_or_a_noun():
    """As an editor shows it: "Return whether ..." or "Number of ...", not "Whether ..."."""
    hanging = [
        f"{path}: {line}"
        for path, tree in TREES.items()
        if path.as_posix().startswith(READ_ALONE)
        for node in ast.walk(tree)
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
        if (line := (ast.get_docstring(node) or "").partition("\n")[0]).startswith(HANGING)
    ]
    assert not hanging, "begin with what it does or what it is: " + "; ".join(hanging)
