"""A beam of pieces against Euler and Bernoulli's, clamped and with a mass at its tip."""

import numpy as np
import pytest
from robots import BAR, ur5_with_bar
from scipy.optimize import brentq

import quietarm as qa


def _wave_numbers(ratio, count=2):
    """Roots of the frequency equation of a clamped beam with a tip mass, in shares of its mass.

    Blevins, Formulas for Natural Frequency and Mode Shape (1979), table 8-8.
    """

    def equation(k):
        tip = np.cos(k) * np.sinh(k) - np.sin(k) * np.cosh(k)
        return 1 + np.cos(k) * np.cosh(k) + ratio * k * tip

    ends = np.linspace(0.1, 15.0, 3000)
    signs = np.sign([equation(k) for k in ends])
    brackets = [(a, b) for a, b, s, t in zip(ends, ends[1:], signs, signs[1:]) if s * t < 0]
    return [brentq(equation, *bracket) for bracket in brackets[:count]]


def _exact(values):
    """Frequencies [rad/s] of both planes, rising."""
    line_mass = values["density"] * values["width"] * values["height"]
    ratio = values["tip_mass"] / (line_mass * values["length"])
    found = list[float]()
    for bends, other in (("width", "height"), ("height", "width")):
        stiffness = values["youngs_modulus"] * values[other] * values[bends] ** 3 / 12
        scale = np.sqrt(stiffness / line_mass) / values["length"] ** 2
        found += [scale * k**2 for k in _wave_numbers(ratio)]
    return sorted(found)


@pytest.mark.parametrize("changes", [
    {}, {"tip_mass": 0.0}, {"tip_mass": 5.0}, {"width": 0.1, "height": 0.004}, {"length": 0.3},
])  # fmt: skip
def test_first_two_frequencies_are_exact_within_half_a_percent(changes):
    values = BAR | changes
    beam = qa.Beam(at="tool0", **values)
    chain = sorted([*beam.frequencies(0), *beam.frequencies(1)])
    assert chain[:2] == pytest.approx(_exact(values)[:2], rel=0.005)


def test_six_pieces_by_default():
    assert qa.Beam(at="tool0", **BAR).pieces == 6
    assert qa.Beam(at="tool0", **BAR, pieces=9).pieces == 9


def test_stiffness_and_mass_in_place_of_a_section():
    by_section = qa.Beam(at="tool0", **BAR)
    of_length = {"length": 0.8, "tip_mass": 0.5, "damping": 0.005}
    given = qa.Beam(
        at="tool0", **of_length, mass_per_length=by_section.line_mass,
        bending_stiffness=by_section.stiffness,
    )  # fmt: skip
    # its pieces have no width, whose turning takes 0.01 % at most
    assert given.frequencies(0)[:2] == pytest.approx(by_section.frequencies(0)[:2], rel=1e-3)


def test_modes_of_a_robot_that_holds_still_are_the_beams():
    """The lowest of each plane, without gravity."""
    robot = ur5_with_bar(gravity=(0.0, 0.0, 0.0))
    beam = robot.beam
    lowest = sorted([beam.frequencies(0)[0], beam.frequencies(1)[0]])
    assert robot.frequencies([0.3, -1.2, 1.0, 0.4, 0.2, 0.1])[:2] == pytest.approx(lowest, rel=1e-9)


def test_sag_is_that_of_a_cantilever():
    """P l^3 / (3 E I) and q l^4 / (8 E I), across a bar that lies level."""
    robot = ur5_with_bar()
    beam = robot.beam
    level = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]  # the flange of the UR5 looks sideways, its z is level
    load = beam.tip_mass * beam.length**3 / 3 + beam.line_mass * beam.length**4 / 8
    sag = np.linalg.norm(robot.sag(level)[:2])
    stiffness = [9.80665 * load / sag]
    least, most = sorted(beam.stiffness)
    assert 0.98 * least < stiffness[0] < 1.02 * most


def test_damping_is_that_of_the_first_mode():
    beam = qa.Beam(at="tool0", **BAR)
    first = min(beam.frequencies(0)[0], beam.frequencies(1)[0])
    assert beam.damping_time * first / 2 == pytest.approx(0.005)


@pytest.mark.parametrize(("changes", "words"), [
    ({"length": 0.0}, "length of the beam is 0 m; give a positive number"),
    ({"damping": 1.5}, "damping of the beam is 150 %; give a ratio below 1"),
    ({"width": None}, "the beam has no stiffness; give width, height and youngs_modulus"),
    ({"density": None}, "the beam has no mass; give width, height and density"),
    ({"mass_per_length": 0.2}, "density and mass_per_length; give one of them"),
    ({"bending_stiffness": 20.0}, "youngs_modulus and bending_stiffness; give one of them"),
    ({"pieces": 0}, "pieces of the beam is 0; give a whole number from 1 up"),
    ({"pieces": 100}, "pieces of the beam is 100; give at most 20"),
])  # fmt: skip
def test_what_no_beam_has_is_refused(changes, words):
    with pytest.raises(ValueError, match=words):
        qa.Beam(at="tool0", **(BAR | changes))
