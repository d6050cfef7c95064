"""Nouns with their articles and lists with their last word, as messages have them."""

import pytest

from quietarm.models.number_checks import joined, unknown, with_article


@pytest.mark.parametrize(
    ("noun", "words"),
    [
        ("amount", "an amount"), ("angle", "an angle"), ("hour", "an hour"), ("unit", "a unit"),
        ("plan", "a plan"), ("user's own", "a user's own"), ("energy floor", "an energy floor"),
        ("one-off", "a one-off"), ("EI shaper", "an EI shaper"), ("index", "an index"),
    ],
)  # fmt: skip
def test_a_noun_has_its_article(noun, words):
    assert with_article(noun) == words


def test_a_list_ends_in_its_last_word():
    assert joined([]) == ""
    assert joined(["a"]) == "a"
    assert joined(["a", "b"], "or") == "a or b"
    assert joined(iter("abc")) == "a, b and c"


def test_of_many_known_names_a_message_lists_those_that_are_most_alike():
    names = [f"method{number}" for number in range(30)]
    said = unknown("method", "methd17", names)
    assert "did you mean 'method17'? (known: method17, " in said
    assert said.endswith(" and 24 more)")
    assert unknown("letter", "e", "abcd") == "unknown letter 'e' (known: a, b, c, d)"
