"""Input shapers: their residual curves in closed form, and the cycloid that they shape.

Formulas: docs/physics.md, 'Input shaping', after Singer and Seering (1990) and Singhose and others
(1994).
"""

import math
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from quietarm.ocp import CycloidPolynomial, ShapedCycloid
from quietarm.ocp.profiles.shaped_cycloid import LEAST_SHARE, SHAPERS, convolved

pi = math.pi
names = pytest.mark.parametrize("shaper", ["zv", "zvd", "ei", "mzv"])
frequencies = st.floats(2.0, 30.0)
damping = st.floats(0.0, 0.3)
modes = st.lists(st.tuples(frequencies, damping), min_size=1, max_size=2)

# What is left of an undamped vibration whose frequency is r times the one planned for.
CURVES = {
    "zv": lambda r: abs(math.cos(pi * r / 2)),
    "zvd": lambda r: math.cos(pi * r / 2) ** 2,
    "ei": lambda r: abs((1 + 0.05) / 2 * math.cos(pi * r) + (1 - 0.05) / 2),
    # 1 - 1/sqrt(2), sqrt(2) - 1, 1 - 1/sqrt(2), three eighths of a period apart
    "mzv": lambda r: abs((2 - math.sqrt(2)) * math.cos(0.75 * pi * r) + math.sqrt(2) - 1),
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


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.2])
def test_humps_leave_what_is_tolerated_over_ever_wider_ranges(zeta):
    # Singhose, Porter, Tuttle and Singer, J. Dyn. Sys. Meas. Control 119 (1997), define them by 5 %
    # at the top of each hump; Klipper's fits of 2025 keep 5.4 % up to zeta = 0.2
    widths = []
    for shaper in ("ei", "2hump-ei", "3hump-ei"):
        impulses = SHAPERS[shaper](7.0, zeta)
        assert min(impulses.amplitudes) > 0
        assert sum(impulses.amplitudes) == pytest.approx(1)
        ratios = np.linspace(0.4, 1.5, 2201)
        curve = np.array([left(impulses, r * 7.0, zeta) for r in ratios])
        inside = np.flatnonzero(curve <= 0.054)
        assert np.diff(inside[ratios[inside] < 1.4]).max() == 1  # one range
        widths.append(ratios[inside[-1]] - ratios[inside[0]])
    assert widths == sorted(widths)
    if zeta == 0:
        assert widths[0] == pytest.approx(0.40, abs=0.02)  # Singhose, Seering and Singer, 1994


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


@pytest.mark.slow_after(1)
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
    for order in range(4):
        own = [a * plain(t - begin, order) for a, begin in zip(*profile.impulses, strict=True)]
        expected = (0.4 if order == 0 else 0.0) - 1.5 * sum(own)
        size = (40 if order < 3 else 400) / (duration - length) ** order
        assert path(t, order) == pytest.approx(float(expected), abs=1e-9 * size)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("zvdd", (10.0,), (0.0,)), "zvdd"),
        (("zv", (10.0, 12.0), (0.0,)), "2 frequencies"),
        (("zv", (10.0,), (1.0,)), "damping ratio is 1"),
        (("ei", (10.0,), (0.6,)), r"0\.5037"),
    ],
)
def test_bad_numbers_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        ShapedCycloid(*arguments)


def test_the_shortest_duration_that_is_named_is_long_enough():
    profile = ShapedCycloid("zvd", (1.0,), (0.0,))  # its length is the period, 6.3 s
    with pytest.raises(ValueError, match="too short for the zvd shaper") as refused:
        profile.checked([], 6.0)
    named = float(re.search(r"give ([\d.]+) s or more", str(refused.value))[1])
    assert profile.checked([], named) == ()
    assert named == pytest.approx(2 * math.pi / 0.95, abs=1e-4)  # 5 % are left for the cycloid
