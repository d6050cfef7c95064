"""A beam of pieces against Euler and Bernoulli's, clamped and with a mass at its tip."""

import numpy as np
import pytest
from robots import BAR, ur5_with_bar, urdf_of
from scipy.optimize import brentq

import quietarm as qa
from quietarm.ocp.saved import plain, typed


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


# The largest share by which a frequency may be another than Euler and Bernoulli's.
EXACT = 1e-4


def _of_plane(values, along):
    """The first two of Euler and Bernoulli's beam that bends along x (0) or y (1) [rad/s]."""
    bends, other = (("height", "width"), ("width", "height"))[along]
    line_mass = values["density"] * values["width"] * values["height"]
    ratio = values["tip_mass"] / (line_mass * values["length"])
    stiffness = values["youngs_modulus"] * values[other] * values[bends] ** 3 / 12
    scale = np.sqrt(stiffness / line_mass) / values["length"] ** 2
    return [scale * k**2 for k in _wave_numbers(ratio)]


@pytest.mark.parametrize("pieces", [None, 2, 3, 4, 8, 20])
@pytest.mark.parametrize("changes", [
    {}, {"tip_mass": 0.0}, {"tip_mass": 0.02}, {"tip_mass": 0.2}, {"tip_mass": 5.0},
    {"width": 0.1, "height": 0.004}, {"length": 0.3},
])  # fmt: skip
def test_first_two_frequencies_of_each_plane_are_euler_and_bernoullis(changes, pieces):
    values = BAR | changes
    beam = qa.Beam(at="tool0", **values, pieces=pieces)
    for along in (0, 1):
        assert beam.frequencies(along)[:2] == pytest.approx(_of_plane(values, along), rel=EXACT)


@pytest.mark.parametrize(("pieces", "share"), [(4, 0.2), (5, 0.03), (8, 0.003)])
def test_the_third_frequency_is_near(pieces, share):
    """Nothing makes it exact, and it comes nearer with every hinge."""
    beam = qa.Beam(at="tool0", **BAR, pieces=pieces)
    line_mass = BAR["density"] * BAR["width"] * BAR["height"]
    exact = _wave_numbers(BAR["tip_mass"] / (line_mass * BAR["length"]), count=3)
    waves = np.sqrt(beam.frequencies(0) / beam.frequencies(0)[0]) * exact[0]
    assert waves[2] == pytest.approx(exact[2], rel=share)


def test_one_hinge_has_the_first_frequency():
    beam = qa.Beam(at="tool0", **BAR, pieces=1)
    assert beam.frequencies(1) == pytest.approx(_of_plane(BAR, 1)[:1], rel=EXACT)


def test_a_force_at_the_tip_bends_it_by_a_cantilevers_share():
    """F l^3 / (3 E I)."""
    beam = qa.Beam(at="tool0", **BAR)
    arms = beam.length - beam.places
    for axis, stiffness in enumerate(reversed(beam.stiffness)):
        given = np.sum(arms**2 / beam.springs[:, axis])
        assert given == pytest.approx(beam.length**3 / (3 * stiffness), rel=1e-12)


def test_more_modes_get_more_hinges_unless_their_number_is_given():
    assert ur5_with_bar().beam.count == 5
    assert ur5_with_bar(modes=10).beam.count == 7
    six = qa.Beam(at="tool0", **BAR, pieces=6)
    assert qa.Robot(urdf=urdf_of("ur5_robot.urdf"), beam=six, modes=10).beam.count == 6


def test_a_bar_of_version_2_0_has_its_hinges_where_they_were():
    """Six in the middle of equal parts: too stiff by 0.37 % in the first frequency."""
    robot = qa.Robot(urdf=urdf_of("ur5_robot.urdf"), beam=qa.Beam(at="tool0", **BAR, pieces=6))
    saved = plain(robot)
    del saved["beam"]["hinges"]
    beam = typed(saved, qa.Robot).beam
    assert beam.places == pytest.approx(BAR["length"] * (np.arange(6) + 0.5) / 6)
    assert beam.frequencies(1)[0] == pytest.approx(1.0037 * _of_plane(BAR, 1)[0], rel=1e-4)
    # it is judged by exact ones
    assert beam.finer.frequencies(1)[0] == pytest.approx(_of_plane(BAR, 1)[0], rel=EXACT)


def test_stiffness_and_mass_in_place_of_a_section():
    by_section = qa.Beam(at="tool0", **BAR)
    of_length = {"length": 0.8, "tip_mass": 0.5, "damping": 0.005}
    given = qa.Beam(
        at="tool0", **of_length, mass_per_length=by_section.line_mass,
        bending_stiffness=by_section.stiffness,
    )  # fmt: skip
    assert given.frequencies(0) == pytest.approx(by_section.frequencies(0), rel=1e-12)


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
    ({"roll": 90.0}, "roll of the beam is 90 rad, more than a turn; were degrees meant"),
    ({"hinges": "glued"}, "hinges of the beam are 'glued'; give exact"),
])  # fmt: skip
def test_what_no_beam_has_is_refused(changes, words):
    with pytest.raises(ValueError, match=words):
        qa.Beam(at="tool0", **(BAR | changes))
