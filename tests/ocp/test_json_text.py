"""Texts of documents are what Python's json makes of them, however they are written faster."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st
from saved_files import with_whole_numbers

from quietarm.ocp.json_text import texts_of

ENDS_OF_NOTATIONS = [0.0, -0.0, 1e-4, 9.999e-5, -1e-5, 1.5e-7, 10.00001, 1e15, 1e16, 1e22, 5e-324]
NUMBERS = (
    st.floats(allow_nan=False, allow_infinity=False)
    | st.floats(-1e-3, 1e-3)
    | st.integers(-(10**6), 10**6).map(float)
    | st.sampled_from(ENDS_OF_NOTATIONS)
)
OTHERS = NUMBERS | st.integers() | st.text(max_size=5) | st.booleans() | st.none()
DOCUMENTS = st.recursive(
    OTHERS | st.lists(NUMBERS, max_size=6) | st.lists(st.lists(NUMBERS, max_size=4), max_size=4),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner),
    max_leaves=20,
)


@pytest.mark.slow
@given(DOCUMENTS)
def test_the_canonical_text_is_that_of_json_with_sorted_names_and_whole_numbers(document):
    canonical = texts_of(document).canonical
    assert canonical == json.dumps(with_whole_numbers(document), sort_keys=True)


@pytest.mark.slow
@given(DOCUMENTS)
def test_the_indented_text_has_every_entry_in_order_and_every_digit(document):
    indented = texts_of(document).indented
    again = json.loads(indented)
    assert json.dumps(again) == json.dumps(document)


@given(st.lists(NUMBERS, max_size=40))
def test_a_list_of_numbers_stands_on_one_line_as_json_writes_it(numbers):
    assert texts_of(numbers).indented == json.dumps(numbers)


def test_entries_and_rows_have_lines_of_their_own():
    document = {"rows": [[0.5, 1e-05], [2.0, -1.5e-07]], "empty": {}, "words": ["a", None, True]}
    assert texts_of(document).indented.splitlines() == [
        "{",
        '  "rows": [',
        "    [0.5, 1e-05],",
        "    [2.0, -1.5e-07]",
        "  ],",
        '  "empty": {},',
        '  "words": ["a", null, true]',
        "}",
    ]


@pytest.mark.parametrize("odd", [float("nan"), float("inf"), -float("inf")])
@pytest.mark.parametrize("within", [lambda x: x, lambda x: [1.0, x], lambda x: [[1.0], [x]]])
def test_what_is_no_number_of_json_is_refused(odd, within):
    with pytest.raises(ValueError, match="not JSON compliant"):
        texts_of({"entry": within(odd)})
