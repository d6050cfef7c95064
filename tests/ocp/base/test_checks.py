"""Numbers that people give: kept, or refused with the value."""

import math
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from quietarm.ocp.base.checks import finite, listed, positive, whole

NUMBERS = [1, 1.5, np.float32(1.5), np.float64(1.5), np.int16(2), Fraction(3, 2)]
NOT_NUMBERS = [True, np.bool_(True), "1.5", None, [1.5], 1j, Decimal("1.5"), np.array([1.5])]


@pytest.mark.parametrize("check", [finite, positive])
@pytest.mark.parametrize("value", NUMBERS, ids=repr)
def test_a_number_becomes_a_float(check, value):
    number = check("length", value, "m")
    assert type(number) is float
    assert number == value


@pytest.mark.parametrize("check", [finite, positive])
@pytest.mark.parametrize("value", [*NOT_NUMBERS, math.nan, math.inf, -math.inf, 10**400], ids=str)
def test_what_is_no_finite_number_is_named(check, value):
    with pytest.raises(ValueError, match=r"^length is .*; give a (finite )?number in m$") as error:
        check("length", value, "m")
    assert str(value) in str(error.value)


@pytest.mark.parametrize("value", [0, -0.0, -1.5])
def test_what_is_not_positive_is_named(value):
    with pytest.raises(ValueError, match=f"^length is {value:g} m; give a positive number$"):
        positive("length", value, "m")
    assert finite("length", value, "m") == value


def test_a_number_without_a_unit():
    with pytest.raises(ValueError, match=r"^share is -1; give a positive number$"):
        positive("share", -1)


@pytest.mark.parametrize("value", [1, 7, np.int64(7), 10**30])
def test_a_whole_number_becomes_an_int(value):
    assert type(whole("count", value, 1)) is int
    assert whole("count", value, 1) == value


@pytest.mark.parametrize("value", [0, -7, 1.0, 1.5, True, "1", None, math.nan], ids=repr)
def test_what_is_no_whole_number_from_the_least_up_is_named(value):
    with pytest.raises(ValueError, match=r"^count is .*; give a whole number from 1 up$") as error:
        whole("count", value, 1)
    assert repr(value) in str(error.value)


@pytest.mark.parametrize("values", [[1, 2], (1, 2), np.array([1, 2]), iter([1, 2]), range(1, 3)])
def test_values_one_after_another_become_a_list(values):
    assert listed("lengths", values, "a list") == [1, 2]


@pytest.mark.parametrize("values", [1.5, None, "12", b"12", {1: 2}, np.array(1.5)], ids=repr)
def test_what_is_no_list_is_named(values):
    with pytest.raises(ValueError, match=r"^lengths is .*; give a list, as \[1\]$"):
        listed("lengths", values, "a list, as [1]")
