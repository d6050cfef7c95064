"""The methods that are known by name."""

import inspect
import re
from functools import partial
from importlib import import_module
from pathlib import Path

import pytest

from quietarm.metaheuristics import PRESETS
from quietarm.metaheuristics.methods import building

DOCUMENT = Path(__file__).parents[3] / "docs" / "methods.md"
NUMBA = {"agemoea", "agemoea2"}  # pymoo compiles these for seconds as they load
NAMES = pytest.mark.parametrize("name", [name for name in PRESETS if name not in NUMBA])


def test_every_algorithm_of_pymoo_for_two_objectives_is_there():
    # those that are left out: docs/methods.md, "Not included"
    left_out = {"dnsga2", "kgb", "pinsga2", "rnsga2", "rnsga3"}
    folder = Path(import_module("pymoo.algorithms.moo").__path__[0])
    modules = {path.stem for path in folder.glob("*.py")} - {"__init__"}
    sources = {preset.kind.partition(":")[0] for preset in PRESETS.values()}
    mended = import_module("quietarm.metaheuristics.algorithms.pymoo_fixes")
    own = {name for name, _ in inspect.getmembers(mended, inspect.ismodule)}
    in_function = {"age2"}  # of agemoea2, which loads it late: it needs numba
    named = {source.rpartition(".")[2] for source in sources} | own | in_function
    assert modules - left_out <= named
    assert not left_out & named


def contents(thing, seen=None):
    """Everything that an algorithm is set to: the numbers and words in it, at any depth."""
    seen = [] if seen is None else seen
    if isinstance(thing, bool | int | float | str | None):
        return thing
    if isinstance(thing, partial):
        return thing.keywords
    if callable(thing) and not hasattr(thing, "do"):
        return getattr(thing, "__qualname__", type(thing).__name__)
    if not hasattr(thing, "__dict__") or any(thing is other for other in seen):
        return type(thing).__name__
    inner = {name: contents(value, [*seen, thing]) for name, value in vars(thing).items()}
    return type(thing).__name__, inner


@NAMES
def test_the_defaults_are_those_of_the_algorithm_itself(name):
    # what its class does without them: pymoo's own settings, or the paper's
    # nsga2 is of the paper's class, with rates of its own; of slsqp the signature says it
    if name == "nsga2":
        return
    if PRESETS[name].is_function:
        function = PRESETS[name].build(1)
        defaults = {k: p.default for k, p in inspect.signature(function.func).parameters.items()}
        assert {name: defaults[name] for name in function.keywords} == function.keywords
        return
    module, _, kind = PRESETS[name].kind.partition(":")
    kind = getattr(import_module(module), kind)
    if kind.__module__ == "quietarm.metaheuristics.algorithms.pymoo_fixes":
        kind = kind.__mro__[1]
    plain = kind(building.directions(12) if PRESETS[name].by_directions else 12)
    (_, built), (_, wanted) = contents(PRESETS[name].build(12)), contents(plain)
    if name in ("nsga3", "unsga3"):  # whose comparison is mended
        built["mating"][1].pop("selection")
        wanted["mating"][1].pop("selection")
    assert built == wanted


OTHERS = {
    "boundary": "reflect", "velocity_limit": 0.3, "archive_size": 7, "crossover": 0.75,
    "crossover_gene": 0.25, "crossover_eta": 9, "mutation": 0.25, "mutation_gene": 0.3,
    "mutation_eta": 9, "normalise": False, "neighbours": 5, "neighbour_mating": 0.5, "alpha": 3,
    "adaptation": 0.2, "inertia": 0.5, "last_inertia": 0.5, "constriction": 0.7,
    "cognitive": 1, "social": 1, "elites": 4,
    "first_velocity": "zero", "variant": "DE/best/2/exp", "scale": 0.6, "jitter": 0,
    "repair": "midway", "delta": 0.01, "objective_crowding": False, "coefficient_crowding": False,
    "replaced": 3, "first_step": 0.3, "step": 1e-5, "continuation": False,
    "gradient_every": 3, "gradient_points": 4, "gradient_iterations": 2, "solver_tolerance": 1e-6,
    "first": 7, "differences": 0.4, "training": 90, "pool": 500,
}  # fmt: skip


@NAMES
def test_every_setting_reaches_the_algorithm(name):
    population = 1 if PRESETS[name].is_function else 12
    built = contents(PRESETS[name].build(population))
    for setting in PRESETS[name].settings:
        value = OTHERS[setting.name]
        assert value != setting.default
        assert contents(PRESETS[name].build(population, {setting.name: value})) != built


BAD = [
    ("nsga2", {"crossing": 1}, ["nsga2 has no setting 'crossing'", "did you mean 'crossover'"]),
    ("nsga2", {"crossover": 1.5}, ["crossover is 1.5", "0 to 1"]),
    ("nsga2", {"crossover_gene": 0}, ["crossover_gene", "positive"]),
    ("spea2", {"normalise": "maybe"}, ["normalise is 'maybe'", "true or false"]),
    ("moead", {"neighbours": 1}, ["neighbours is 1", "from 2 up"]),
    ("vepso", {"boundary": "clop"}, ["boundary is 'clop'", "did you mean 'clip'"]),
]


@pytest.mark.parametrize(("name", "settings", "words"), BAD)
def test_bad_settings_are_refused_with_the_remedy(name, settings, words):
    with pytest.raises(ValueError, match=re.escape(words[0])) as caught:
        PRESETS[name].build(10, settings)
    assert all(word in str(caught.value) for word in words)


def test_the_document_has_every_method_with_its_settings_and_defaults():
    text = DOCUMENT.read_text(encoding="utf-8")
    for preset in PRESETS.values():
        row = next(line for line in text.splitlines() if line.startswith(f"| `{preset.name}` |"))
        cells = [cell.strip() for cell in row.strip("|").split("|")]
        assert cells[1] == f"{preset.label}, {preset.source}"
        assert cells[2] == f"{preset.population} x {preset.generations}"
        stated = dict(re.findall(r"`(\w+)` ([^,]+)", cells[3]))
        assert stated == {s.name: _written(s.default) for s in preset.settings}
        for setting in preset.settings:
            assert f"| `{setting.name}` |" in text


def _written(default):
    if default is None:
        return "-"
    return (
        f"{default:g}" if isinstance(default, float) else str(default).lower().replace("de/", "DE/")
    )
