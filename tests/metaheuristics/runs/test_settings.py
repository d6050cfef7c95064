"""What a search is: typed, in a document and back."""

import json

import pytest
from quietarm.metaheuristics.runs.settings import SearchSettings, SearchSpec
from quietarm.ocp import CycloidPolynomial
from quietarm.ocp.answers.documents import plain, typed
from small_searches import HALF, LIMITED, SIXTH

SETTINGS = SearchSettings(0.5, 20, 15)


def spec(task=HALF, settings=SETTINGS, **changes):
    given = {"profile": CycloidPolynomial(5), "method": "nsga2", "seed": 3, "algorithm": {"a": 1}}
    return SearchSpec(task=task, settings=settings, **{**given, **changes})


@pytest.mark.parametrize(
    "one",
    [
        spec(),
        spec(SIXTH, algorithm={"particles": 8, "rule": {"social": 2.05}, "archive_size": None}),
        spec(LIMITED["vepso"], SearchSettings(0.1 + 0.2, None, 1), seed=0),
    ],
    ids=["free", "nested settings", "limits"],
)
def test_a_search_comes_back_from_its_document(one):
    assert typed(json.loads(json.dumps(plain(one))), SearchSpec) == one


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((0.0, 20, 15), "bound on the coefficients is 0"),
        ((0.5, 1, 15), "population is 1; give a whole number from 2"),
        ((0.5, 20, 0), "generations is 0; give a whole number from 1"),
    ],
)
def test_settings_out_of_range_are_refused_wherever_they_come_from(arguments, words):
    with pytest.raises(ValueError, match=words):
        SearchSettings(*arguments)
    document = plain(spec())
    document["settings"] = dict(zip(document["settings"], arguments, strict=True))
    with pytest.raises(ValueError, match=words):
        typed(document, SearchSpec)
