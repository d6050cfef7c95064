"""Angles, lengths, times and coefficients as people write them."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

import quietarm as qa
from quietarm.ocp import PositivePower
from quietarm.studies.cli.quantities import (
    parse_coefficients,
    parse_energy,
    parse_quantity,
    parse_scales,
    read_settings,
)

WHOLE = st.integers(0, 100_000)
FINITE = st.floats(allow_nan=False, allow_infinity=False)


@pytest.mark.parametrize(
    ("unit", "text", "number"),
    [
        ("rad", "-1.5", -1.5),
        ("rad", "  0.5 rad ", 0.5),
        ("rad", "30deg", math.pi / 6),
        ("rad", "-90 deg", -math.pi / 2),
        ("rad", "30 degrees", math.pi / 6),
        ("rad", "30°", math.pi / 6),
        ("rad", "+pi", math.pi),
        ("rad", "pi / 4", math.pi / 4),
        ("rad", "2*pi/3", 2 * math.pi / 3),
        ("rad", "-0.75 pi", -0.75 * math.pi),
        ("rad/s", "60 deg/s", math.pi / 3),
        ("rad/s", "60deg", math.pi / 3),
        ("rad/s", "2Hz", 4 * math.pi),
        ("rad/s", "60rpm", 2 * math.pi),
        ("rad/s^2", "180deg/s^2", math.pi),
        ("rad/s^3", "3 rad/s^3", 3.0),
        ("m", "2 cm", 0.02),
        ("m", "3µm", 3e-6),
        ("s", "800ms", 0.8),
        ("N m", "200mNm", 0.2),
        ("kg", "200g", 0.2),
        ("-", "10%", 0.1),
    ],
)
def test_quantities_as_people_write_them(unit, text, number):
    assert parse_quantity(text, unit, "one") == pytest.approx(number, rel=1e-15)


@pytest.mark.parametrize("text", ["angle=2pi/4096", "angle=2PI/4096", "Angle = 2 * Pi / 4096"])
def test_a_scale_is_typed_in_large_letters_too(text):
    assert parse_scales(text) == [("angle", 2 * math.pi / 4096)]


@given(FINITE, st.sampled_from(["rad", "m", "s", "N m", "kg m^2"]))
def test_a_plain_number_comes_back_as_it_was(number, unit):
    assert parse_quantity(repr(number), unit, "one") == number


@given(st.sampled_from(["", "+", "-"]), st.integers(1, 1000), st.integers(1, 1000))
def test_multiples_of_pi_round_trip(sign, factor, divisor):
    size = parse_quantity(f"{sign}{factor}*pi/{divisor}", "rad", "one") * divisor / factor
    assert size == pytest.approx(-math.pi if sign == "-" else math.pi, rel=1e-14)


@given(WHOLE)
def test_milliseconds_are_the_same_number_as_seconds(count):
    # Else 700ms and 0.7 are two tasks, and a file says 0.7000000000000001.
    assert parse_quantity(f"{count}ms", "s", "one") == parse_quantity(
        repr(count / 1000), "s", "one"
    )


@pytest.mark.parametrize("text", ["", "30degs", "1mm", "pi/", "five"])
def test_what_is_no_angle_is_refused_with_examples(text):
    with pytest.raises(ValueError, match="give radians") as refused:
        parse_quantity(text, "rad", "an angle")
    assert str(refused.value).startswith(f"{text!r} is not an angle; ")
    assert "30deg" in str(refused.value)


@given(st.lists(FINITE, min_size=1, max_size=20))
def test_coefficients_round_trip(values):
    assert parse_coefficients(",".join(map(repr, values))) == values


ENERGIES = {
    "absolute": qa.AbsolutePower(),
    "positive": PositivePower(),
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
    ("text", "value"),
    [("0.25", 0.25), ("25%", 0.25), ("25 %", 0.25), ("3", 3), ("true", True), ("SBX", "SBX")],
)
def test_a_setting_is_a_number_a_share_a_flag_or_a_word(text, value):
    settings = read_settings([("nsga2.crossover", text)])
    assert settings == {"nsga2.crossover": value}
    assert type(settings["nsga2.crossover"]) is type(value)
