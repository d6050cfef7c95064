"""Input shapers: their residual curves in closed form, and the cycloid that they shape.

Formulas: docs/physics.md, 'Input shaping', after Singer and Seering (1990) and Singhose and others
(1994).
"""

import math

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from quietarm.ocp import CycloidPolynomial, ShapedCycloid
from quietarm.ocp.profiles.shaped_cycloid import LEAST_SHARE
from quietarm.ocp.profiles.shapers import SHAPERS, convolved

pi = math.pi
names = pytest.mark.parametrize("shaper", ["zv", "zvd", "ei"])
frequencies = st.floats(2.0, 30.0)
damping = st.floats(0.0, 0.3)
modes = st.lists(st.tuples(frequencies, damping), min_size=1, max_size=2)

# What is left of an undamped vibration whose frequency is r times the one planned for.
CURVES = {
    "zv": lambda r: abs(math.cos(pi * r / 2)),
    "zvd": lambda r: math.cos(pi * r / 2) ** 2,
    "ei": lambda r: abs((1 + 0.05) / 2 * math.cos(pi * r) + (1 - 0.05) / 2),
}


def left(impulses, frequency, damping_ratio=0.0):
    """Residual percentage: what the impulses leave of a mode, over what one impulse would leave."""
    decay = damping_ratio * frequency
    damped = frequency * math.sqrt(1 - damping_ratio**2)
    end = impulses.times[-1]
    phasors = (
        share * np.exp((decay + 1j * damped) * (t - end))
        for share, t in zip(*impulses, strict=True)
    )
    return abs(sum(phasors))


def _profile(shaper, pairs):
    return ShapedCycloid(shaper, *map(tuple, zip(*pairs, strict=True)))


# -- residual curves --


@names
@given(frequency=frequencies, r=st.floats(0.5, 1.5))
def test_an_undamped_mode_is_left_by_the_closed_form(shaper, frequency, r):
    impulses = SHAPERS[shaper](frequency, 0.0)
    assert left(impulses, r * frequency) == pytest.approx(CURVES[shaper](r), abs=1e-12)


@names
@given(frequency=frequencies, zeta=damping)
def test_a_damped_mode_is_left_at_its_own_frequency_as_an_undamped_one(shaper, frequency, zeta):
    impulses = SHAPERS[shaper](frequency, zeta)
    expected = 0.05 if shaper == "ei" else 0.0
    assert left(impulses, frequency, zeta) == pytest.approx(expected, abs=1e-12)


@given(frequency=frequencies, zeta=st.floats(0.0, 0.1))
def test_zvd_is_flat_at_its_frequency_and_zv_is_not(frequency, zeta):
    # Left of a mode 1e-3 off: proportional to the error for ZV, to its square for ZVD.
    off = frequency * 1.001
    assert left(SHAPERS["zvd"](frequency, zeta), off, zeta) < 5e-6
    assert left(SHAPERS["zv"](frequency, zeta), off, zeta) > 1e-3


@pytest.mark.parametrize(
    ("shaper", "width"),
    [
        # Where the curves above reach 5 %: |cos| = 0.05, cos^2 = 0.05, cos(pi r) = -0.85/1.05.
        ("zv", 4 / pi * math.asin(0.05)),  # 0.064
        ("zvd", 4 / pi * math.asin(math.sqrt(0.05))),  # 0.287
        ("ei", 2 - 2 / pi * math.acos(-0.85 / 1.05)),  # 0.400
    ],
)
def test_the_insensitivity_at_5_percent(shaper, width):
    impulses = SHAPERS[shaper](10.0, 0.0)
    for r in (1 - width / 2, 1 + width / 2):
        assert left(impulses, 10 * r) == pytest.approx(0.05, abs=1e-12)
    inside = np.linspace(1 - width / 2, 1 + width / 2, 101)[1:-1]
    assert max(left(impulses, 10 * r) for r in inside) <= 0.05 + 1e-12


def test_the_impulses_in_the_textbooks_form():
    # docs/physics.md: ZV [1, K]/(1 + K), ZVD [1, 2K, K^2]/(1 + K)^2, EI undamped.
    zeta, damped = 0.1, 7.0 * math.sqrt(1 - 0.1**2)
    K, half = math.exp(-zeta * pi / math.sqrt(1 - zeta**2)), pi / damped
    zv, zvd, ei = (SHAPERS[name](7.0, zeta) for name in ("zv", "zvd", "ei"))
    assert zv.amplitudes == pytest.approx([1 / (1 + K), K / (1 + K)])
    assert zvd.amplitudes == pytest.approx([x / (1 + K) ** 2 for x in (1, 2 * K, K**2)])
    assert zv.times == pytest.approx([0, half])
    assert zvd.times == ei.times == pytest.approx([0, half, 2 * half])
    undamped = SHAPERS["ei"](7.0, 0.0).amplitudes
    assert undamped == pytest.approx([1.05 / 4, 0.95 / 2, 1.05 / 4])


# -- several modes --


@names
@given(first=st.tuples(frequencies, damping), second=st.tuples(frequencies, damping))
def test_what_is_left_by_two_shapers_is_the_product(shaper, first, second):
    one, other = SHAPERS[shaper](*first), SHAPERS[shaper](*second)
    both = convolved([one, other])
    assert len(both.times) == len(one.times) * len(other.times)
    assert list(both.times) == sorted(both.times)
    assert sum(both.amplitudes) == pytest.approx(1.0)
    assert both.times[-1] == pytest.approx(one.times[-1] + other.times[-1])
    for mode in (first, second, (5.0, 0.0)):
        assert left(both, *mode) == pytest.approx(left(one, *mode) * left(other, *mode), abs=1e-9)


# -- the cycloid that they shape --


@names
@settings(max_examples=20)
@given(pairs=modes, share=st.floats(LEAST_SHARE, 0.9), fraction=st.floats(0, 1))
def test_it_is_a_sum_of_plain_cycloids(shaper, pairs, share, fraction):
    profile = _profile(shaper, pairs)
    length = profile.length
    duration = length / (1 - share) * (1 + 1e-12)
    path = profile.path([], 0.4, -1.1, duration)
    plain = CycloidPolynomial(0).path([], 0.0, 1.0, duration - length)
    t = fraction * duration
    for order in range(3):
        own = [a * plain(t - begin, order) for a, begin in zip(*profile.impulses, strict=True)]
        expected = (0.4 if order == 0 else 0.0) - 1.5 * sum(own)
        size = 40 / (duration - length) ** order
        assert path(t, order) == pytest.approx(float(expected), abs=1e-9 * size)


@names
@settings(max_examples=20)
@given(pairs=modes, share=st.floats(LEAST_SHARE, 0.9), start=st.floats(-3, 3))
def test_the_joint_rests_at_both_ends_and_does_not_turn_back(shaper, pairs, share, start):
    profile = _profile(shaper, pairs)
    duration = profile.length / (1 - share) * (1 + 1e-12)
    path, ends = profile.path([], start, 2.0, duration), [0.0, duration]
    assert path(ends) == pytest.approx([start, 2.0], abs=1e-12)
    cycloid = duration - profile.length
    for order in (1, 2):
        assert path(ends, order) == pytest.approx([0, 0], abs=1e-12 / cycloid**order)
    angles = path(np.linspace(0.0, duration, 400))
    assert np.all(np.diff(angles) * np.sign(2.0 - start) >= -1e-12)


@names
def test_the_jerk_is_the_limit_of_differences(shaper):
    profile = ShapedCycloid(shaper, (10.4, 12.6), (0.01, 0.02))
    duration, h = 1.5, 1e-6
    path, t = profile.path([], 0.0, 1.0, duration), np.linspace(0.011, duration - 0.011, 97)
    differences = (path(t + h, 2) - path(t - h, 2)) / (2 * h)
    assert path(t, 3) == pytest.approx(differences, abs=1e-5 * np.abs(path(t, 3)).max())
    # The first cycloid begins, and the last one ends, with its share of (2 pi)^2 / cycloid^3.
    shares = np.array(profile.impulses.amplitudes)[[0, -1]]
    ends = shares * (2 * pi) ** 2 / (duration - profile.length) ** 3
    assert path([0.0, duration], 3) == pytest.approx(ends)


def test_numbers_symbols_and_matrices_give_the_same():
    profile = ShapedCycloid("zvd", (10.4,), (0.01,))
    grid = np.linspace(0, 1, 12).reshape(3, 4)
    x, X = ca.SX.sym("x"), ca.MX.sym("X", 3, 4)
    of_scalars = ca.Function("s", [x], profile.derivatives([], x, 0.0, 1.0, 0.8))
    of_matrices = ca.Function("m", [X], profile.derivatives([], X, 0.0, 1.0, 0.8))
    for k, matrix in enumerate(of_matrices.call([ca.DM(grid)])):
        numbers = profile.derivatives([], ca.DM(grid), 0.0, 1.0, 0.8)[k].full()
        scalars = [[float(of_scalars(value)[k]) for value in row] for row in grid]
        assert matrix.full() == pytest.approx(numbers, abs=1e-12)
        assert np.array(scalars) == pytest.approx(numbers, abs=1e-9)


# -- the least duration, and bad input --


@pytest.mark.parametrize("frequency", np.linspace(5.0, 15.0, 11))
def test_the_least_duration_is_never_rounded_down(frequency):
    profile = ShapedCycloid("zv", (frequency,), (0.01,))
    with pytest.raises(ValueError, match="too short") as caught:
        profile.path([], 0.0, 1.0, 0.1)
    named = float(str(caught.value).split("give ")[1].split()[0])
    assert profile.least_duration <= named < profile.least_duration * 1.001


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("zvdd", (10.0,), (0.0,)), "shaper is 'zvdd'; give zv, zvd, ei"),
        (("zv", (), ()), "got 0 frequencies"),
        (("zv", (10.0, 12.0), (0.0,)), "got 2 frequencies and 1 damping"),
        (("zv", (0.0,), (0.0,)), "frequency is 0 rad/s; give a positive"),
        (("zv", (-1.0,), (0.0,)), "frequency is -1 rad/s"),
        (("zv", (math.inf,), (0.0,)), "frequency is inf"),
        (("zv", (10.0,), (1.0,)), "damping ratio is 1; give one between -1 and 1"),
        (("zv", (10.0,), (math.nan,)), "damping ratio is nan"),
        (("zvd", (10.0,) * 6, (0.0,) * 6), "729 impulses"),
        (("ei", (10.0,), (0.6,)), r"0\.6, for which the ei .* up to 0\.5037: take zv or zvd"),
        (("ei", (10.0, 8.0), (0.1, 0.51)), r"damping ratio is 0\.51"),
    ],
)
def test_bad_numbers_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        ShapedCycloid(*arguments)


@pytest.mark.parametrize(("shaper", "most"), [("zv", 0.99), ("zvd", 0.99), ("ei", 0.5037)])
def test_impulses_are_positive_up_to_the_largest_damping(shaper, most):
    for zeta in np.linspace(-most, most, 100):
        amplitudes = ShapedCycloid(shaper, (10.0,), (zeta,)).impulses.amplitudes
        assert min(amplitudes) > 0
        assert sum(amplitudes) == pytest.approx(1)
