"""A search, or an indicator, that is not complete is refused when it is defined."""

from dataclasses import dataclass

import pytest

import quietarm as qa
from quietarm.metaheuristics import PRESETS

pytestmark = pytest.mark.usefixtures("what_is_made_up_is_forgotten")


def run(self, function, seed, budget):
    """Search as a complete search does."""


@pytest.mark.parametrize(
    ("entries", "told"),
    [
        ({"name": "My search", "run": run}, "name of the search Mine is 'My search'; give small"),
        ({"name": "epsilon", "run": run}, "search epsilon has the name of a gradient method"),
        ({"name": "mine"}, r"search mine does nothing; define run\(self, function, seed, budget\)"),
    ],
)
def test_a_search_that_is_not_complete_is_refused(entries, told):
    with pytest.raises(ValueError, match=told):
        type("Mine", (qa.SearchMethod,), entries)


def test_a_search_of_the_name_of_another_is_refused():
    mine = type("Mine", (qa.SearchMethod,), {"name": "nsga2", "run": run})
    with pytest.raises(ValueError, match="name 'nsga2' of the search Mine is quietarm's own"):
        list(PRESETS)
    assert PRESETS["nsga2"].own is not mine


def test_a_setting_needs_a_default_and_keeps_its_kind():
    @dataclass(frozen=True)
    class Mine(qa.SearchMethod):
        name = "mine"
        steps: int
        run = run

    with pytest.raises(ValueError, match="steps of the search mine has no default; give a number"):
        PRESETS["mine"]

    @dataclass(frozen=True)
    class Mended(qa.SearchMethod):
        name = "mine"
        steps: int = 3
        run = run

    with pytest.raises(ValueError, match=r"steps is 0\.5; give a whole number"):
        PRESETS["mine"].checked(1, {"steps": 0.5})


def test_a_search_that_asks_for_nothing_is_refused():
    mine = type("Mine", (qa.SearchMethod,), {"name": "mine", "run": run})
    task = qa.PointToPoint(qa.SingleLinkManipulator(), target=0.5, duration=0.8)
    with pytest.raises(ValueError, match="search mine asked for no candidate; call function"):
        qa.search(task, algorithm=mine(), bound=0.2)


def test_an_indicator_needs_a_name_that_heads_a_column():
    with pytest.raises(ValueError, match="name of the indicator Mine is 'my own'; give letters"):
        type("Mine", (qa.Indicator,), {"name": "my own"})
    with pytest.raises(ValueError, match=r"indicator mine measures nothing; define value\(self"):
        type("Mine", (qa.Indicator,), {"name": "mine"})
    with pytest.raises(AttributeError, match=r"INDICATORS is gone; give known_indicators\(\)"):
        __import__("quietarm.metaheuristics.score", fromlist=["x"]).INDICATORS  # noqa: B018
