"""Angles, lengths, times and coefficients as people write them."""

import math
from functools import partial

import pytest
from hypothesis import given
from hypothesis import strategies as st
from quietarm.studies.cli.quantities import (
    parse_angle,
    parse_coefficients,
    parse_energy,
    parse_length,
    parse_rate,
    parse_time,
    parse_torque,
    parse_weights,
    parse_whole,
)

import quietarm as qa

WHOLE = st.integers(0, 100_000)
FINITE = st.floats(allow_nan=False, allow_infinity=False)


@pytest.mark.parametrize(
    ("parse", "text", "number"),
    [
        (parse_angle, "-1.5", -1.5),
        (parse_angle, "  0.5 rad ", 0.5),
        (parse_angle, "30deg", math.pi / 6),
        (parse_angle, "-90 deg", -math.pi / 2),
        (parse_angle, "30 degrees", math.pi / 6),
        (parse_angle, "30°", math.pi / 6),
        (parse_angle, "+pi", math.pi),
        (parse_angle, "pi / 4", math.pi / 4),
        (parse_angle, "2*pi/3", 2 * math.pi / 3),
        (parse_angle, "-0.75 pi", -0.75 * math.pi),
        (partial(parse_rate, order=1), "60 deg/s", math.pi / 3),
        (partial(parse_rate, order=2), "180deg/s^2", math.pi),
        (partial(parse_rate, order=3), "3 rad/s^3", 3.0),
        (parse_length, "2 cm", 0.02),
        (parse_length, "3µm", 3e-6),
        (parse_time, "800ms", 0.8),
        (parse_torque, "200mNm", 0.2),
        (parse_whole, " 1_000 ", 1000),
        (parse_whole, "1e3", 1000),
    ],
)
def test_quantities_as_people_write_them(parse, text, number):
    assert parse(text) == pytest.approx(number, rel=1e-15)


@given(FINITE)
@pytest.mark.parametrize("parse", [parse_angle, parse_length, parse_time])
def test_a_plain_number_comes_back_as_it_was(parse, number):
    assert parse(repr(number)) == number


@given(st.sampled_from(["", "+", "-"]), st.integers(1, 1000), st.integers(1, 1000))
def test_multiples_of_pi_round_trip(sign, factor, divisor):
    size = parse_angle(f"{sign}{factor}*pi/{divisor}") * divisor / factor
    assert size == pytest.approx(-math.pi if sign == "-" else math.pi, rel=1e-14)


@given(WHOLE)
def test_milliseconds_are_the_same_number_as_seconds(count):
    # Else 700ms and 0.7 are two tasks, and a file says 0.7000000000000001.
    assert parse_time(f"{count}ms") == parse_time(repr(count / 1000))


@pytest.mark.parametrize(
    "text",
    ["", "30degs", "1mm", "pi/", "five"],
)
def test_what_is_no_angle_is_refused_with_examples(text):
    with pytest.raises(ValueError, match="give radians") as refused:
        parse_angle(text)
    assert str(refused.value).startswith(f"{text!r} is not an angle; ")
    assert "30deg" in str(refused.value)


def test_a_decimal_comma_is_told():
    with pytest.raises(ValueError, match=r"'1,5' is not an angle; give 1\.5, with a point"):
        parse_angle("1,5")


@given(st.lists(FINITE, min_size=1, max_size=20))
def test_coefficients_round_trip(values):
    assert parse_coefficients(",".join(map(repr, values))) == values


def test_weights_are_a_pair():
    assert parse_weights("1:3") == (1.0, 3.0)
    assert parse_weights(" 0.5 : 2e1") == (0.5, 20.0)
    for text in ("", "1", "1:2:3", "1:", "a:b", "1/3"):
        with pytest.raises(ValueError, match="is no pair of weights; give those of residual"):
            parse_weights(text)


ENERGIES = {
    "absolute": qa.AbsolutePower(),
    "positive": qa.PositivePower(),
    "copper:0.12": qa.CopperLoss(0.12),
    "0.5*absolute+copper:0.12": 0.5 * qa.AbsolutePower() + qa.CopperLoss(0.12),
}


@pytest.mark.parametrize("text", ENERGIES)
def test_an_energy_is_typed_as_it_is_called(text):
    assert parse_energy(text) == ENERGIES[text]
    assert parse_energy(text).label == text
    assert parse_energy(text.replace("*", " * ").replace("+", " + ")) == ENERGIES[text]
    assert parse_energy(text.replace("0.12", "0.0012e+2")) == ENERGIES[text]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("cooper:1", r"unknown energy 'cooper'; did you mean 'copper'\? \(known: absolute"),
        ("copper", "'copper' has 0 numbers of 1; give copper:motor_constant"),
        ("copper:x", "motor_constant is 'x'; give a number"),
        ("-1*absolute", "weight is -1; give a positive number"),
    ],
)
def test_what_is_no_energy_is_refused_with_a_remedy(text, message):
    with pytest.raises(ValueError, match=message):
        parse_energy(text)
