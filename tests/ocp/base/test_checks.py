"""Numbers that people give: kept, or refused with the value."""

import math

import pytest
from quietarm.ocp.base.checks import finite, not_negative, positive, whole


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
