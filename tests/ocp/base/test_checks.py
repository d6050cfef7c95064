"""Numbers that people give: kept, or refused with the value."""

import math
from fractions import Fraction

import numpy as np
import pytest
from quietarm.ocp.base.checks import finite, not_negative, positive, whole


@pytest.mark.parametrize("value", [1, 1.5, np.float32(1.5), np.int16(2), Fraction(3, 2)], ids=repr)
def test_a_number_becomes_a_float(value):
    for check in (finite, positive, not_negative):
        number = check("length", value, "m")
        assert type(number) is float
        assert number == value


@pytest.mark.parametrize("value", [1, 7, np.int64(7), 10**30])
def test_a_whole_number_becomes_an_int(value):
    assert type(whole("count", value, 1)) is int
    assert whole("count", value, 1) == value


@pytest.mark.parametrize(
    ("check", "value", "remedy"),
    [
        *((finite, value, "give a finite number in m") for value in (math.nan, -math.inf)),
        *((positive, value, "give a positive number") for value in (0, -1.5)),
        (not_negative, -1.5, "give 0 or more"),
        *((whole, value, "give a whole number from 1 up") for value in (0, 1.0, "1", None)),
    ],
)
def test_what_is_out_of_range_is_named_with_the_remedy(check, value, remedy):
    arguments = (1,) if check is whole else ("m",)
    with pytest.raises(ValueError, match=rf"^length is .*; {remedy}$") as error:
        check("length", value, *arguments)
    assert str(value) in str(error.value)
