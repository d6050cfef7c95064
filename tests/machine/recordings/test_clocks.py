"""Clocks of recorders: counters that wrap, clocks that start anew, rows out of order, holes."""

import math
from functools import partial

import numpy as np
import pytest

import quietarm as qa
from quietarm.machine.identify import identify, predict
from quietarm.machine.recordings.clocks import running

STEP = 0.004
OMEGA, ZETA = math.tau * 3.2, 0.01


def swing(count=1500, step=STEP):
    """A free swing of 20 mm at 3.2 Hz with noise: times from 0 on, and the tip."""
    t = step * np.arange(count)
    tip = 20 * np.exp(-ZETA * OMEGA * t) * np.cos(OMEGA * math.sqrt(1 - ZETA**2) * t)
    return t, tip + np.random.default_rng(0).normal(0, 0.05, count)


def counted(seconds, tick, bits, signed):
    """Times as a counter of whole ticks has them [s]."""
    ticks = np.floor(seconds / tick + 0.5) % 2**bits
    if signed:
        ticks = np.where(ticks >= 2 ** (bits - 1), ticks - 2**bits, ticks)
    return ticks * tick


def test_a_time_of_day_goes_on_after_midnight():
    true = 86400.0 - 3.0 + 0.004 * np.arange(1500)
    clock = running(true % 86400.0)
    assert clock.time == pytest.approx(true)
    (words,) = clock.changes.values()
    assert words.startswith("its clock, a time of day, wraps after row 750")
    with pytest.raises(ValueError, match="two recordings"):  # no midnight, but a second start
        running(np.concatenate([true - 20.0, 0.004 * np.arange(1500)]))


@pytest.mark.parametrize("signed", [False, True])
@pytest.mark.parametrize(
    ("bits", "tick", "step", "known"),
    [
        (16, 1e-3, 0.02, False),
        (16, 1e-6, 2e-4, False),
        (24, 1e-6, 0.004, False),
        (24, 1e-7, 1e-3, False),
        (32, 1e-6, 0.8, False),
        (32, 1e-9, 1e-3, False),
        (24, 1 / 84e6, 1e-4, True),  # a timer of 84 MHz, by its scale alone
    ],
)
def test_a_counter_that_wraps_several_times_is_unwrapped(bits, tick, step, known, signed):
    period = 2**bits * tick
    count = int(2.6 * period / step)
    true = 0.7 * period + np.round(step / tick) * tick * np.arange(count)
    wrapped = counted(true, tick, bits, signed)
    wraps = np.flatnonzero(np.diff(wrapped) < 0)
    assert len(wraps) >= 2
    kept = np.ones(count, bool)
    kept[wraps[0] - 1 : wraps[0] + 3] = False  # samples lack around the first
    clock = running(wrapped[kept], tick if known else 0.0)
    assert np.diff(clock.time) == pytest.approx(np.diff(true[kept]), rel=1e-6, abs=tick)
    (words,) = clock.changes.values()
    last = int(np.count_nonzero(kept[: wraps[0] + 1]))
    assert f"a counter of {bits} bits, wraps after row {last} and {len(wraps) - 1} more" in words


@pytest.mark.parametrize("jitter", [0.0, 0.2])
@pytest.mark.parametrize("lack", [0, 60])
def test_a_wrap_is_found_beside_jitter_and_lacking_samples(jitter, lack):
    random = np.random.default_rng(1)
    true = 4290 + STEP * (np.arange(3000) + jitter * random.uniform(-1, 1, 3000))
    kept = np.ones(3000, bool)
    kept[1240 : 1240 + lack] = False  # 2^32 us are 4294.967 s
    clock = running(counted(true, 1e-6, 32, False)[kept])
    assert clock.time == pytest.approx(np.round(true[kept], 6), abs=2e-6)


def test_a_wrapped_recording_tells_what_the_whole_one_does():
    t, tip = swing()
    plain = identify([qa.Recording(t, tip=tip)], qa.FlexibleBeam())
    late = counted(t + 2**32 * 1e-6 - 3, 1e-6, 32, False)
    found = identify([qa.Recording(late, tip=tip)], qa.FlexibleBeam())
    assert found.plant.omega == pytest.approx(plain.plant.omega, rel=1e-6)
    assert found.plant.zeta == pytest.approx(plain.plant.zeta, rel=1e-5)
    assert "a counter of 32 bits, wraps after row 750" in found.warnings[0]


@pytest.mark.parametrize("first", [1000, 60])
@pytest.mark.parametrize("offset", [0.0, 0.0007, STEP / 2])
def test_a_clock_that_starts_anew_is_two_recordings(first, offset):
    t, tip = swing(first)
    again, more = swing(1200)
    time = np.append(t, again + offset)
    with pytest.raises(ValueError, match=f"two recordings, the second from row {first + 1}: give"):
        qa.Recording(time, tip=np.append(tip, more))


def test_rows_are_counted_as_in_the_file_where_some_have_no_number():
    t, tip = swing(1000)
    tip[10:20] = np.nan
    with pytest.raises(ValueError, match="second from row 1001"):
        qa.Recording(np.append(t, t), tip=np.append(tip, tip))
    with pytest.raises(ValueError, match=r"3 recordings in one, .* at rows 1001, 2001"):
        qa.Recording(np.tile(t, 3), tip=np.tile(tip, 3))


def test_swapped_rows_are_put_in_order_and_a_stray_stamp_is_left_out():
    t, tip = swing()
    order = np.arange(len(t))
    order[[700, 701, 900, 903]] = [701, 700, 903, 900]
    swapped = qa.Recording(t[order], tip=tip[order])
    assert np.array_equal(swapped.time, t)
    assert np.array_equal(swapped.tip, tip)
    assert "rows are not in the order of time, the first row 701" in swapped.mended["order"]
    stray = t.copy()
    stray[800] = 0.0
    left = qa.Recording(stray, tip=tip)
    assert len(left.time) == len(t) - 1
    assert "1 row is left out, the first row 801" in left.mended["stray"]


def test_a_clock_that_was_set_back_is_not_sorted():
    t, tip = swing()
    set_back = np.where(t > 3, t - 2.6 * STEP, t)
    with pytest.raises(ValueError, match=r"by 0\.0064 s after row 751: its clock was set"):
        qa.Recording(set_back, tip=tip)


@pytest.mark.parametrize("hole", [0.9, 86_400.0])
def test_a_hole_is_named_and_bears_on_no_answer(hole):
    t, tip = swing(2000)
    late = t > 4
    apart = qa.Recording(t + hole * late, tip=np.where(late, np.append(tip[:999], tip[:1001]), tip))
    found = identify([apart], qa.FlexibleBeam())
    assert found.plant.omega == pytest.approx(OMEGA, rel=1e-3)
    assert "a hole of" in found.warnings[0]
    assert "after row 1001, at 4 s" in found.warnings[0]


def test_a_moving_joint_is_followed_through_no_hole():
    time = np.arange(0, 8, STEP)
    arm = qa.FlexibleBeam(omega=OMEGA, zeta=ZETA)
    move = qa.evaluate_coefficients(qa.PointToPoint(arm, 1.0, 0.6), []).sampled(time)
    kept = (time < 0.1) | (time > 0.65)
    recording = qa.Recording(time[kept], move.joint[kept, 0], tip=move.tips[kept, 0])
    assert min(part.begin for part in identify([recording], arm).parts) > 0.6


T = np.linspace(0, 2, 400)
RING = np.cos(20 * T)
BEAM = qa.FlexibleBeam()
GOOD = qa.Recording(T, tip=RING)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (partial(qa.Recording, time="x"), "time is 'x'; give an array of numbers"),
        (partial(qa.Recording, None, tip=RING), "has no time"),
        (partial(qa.Recording, [], tip=[]), "has nothing in its time"),
        (partial(qa.Recording, 3.0, tip=RING), r"time has shape \(\)"),
        (partial(qa.Recording, T[:, None], tip=RING), r"time has shape \(400, 1\)"),
        (partial(qa.Recording, T, tip=[[1, 2], [3]]), r"tip is \[\[1, 2\], \[3\]\]; give an array"),
        (partial(qa.Recording, T, tip=["1"] * 400), "give an array of numbers"),
        (partial(qa.Recording, T, tip=RING + 0j), "give an array of numbers"),
        (partial(qa.Recording, T, tip=RING > 0), "give an array of numbers"),
        (partial(qa.Recording, T, tip=np.array([{}] * 400)), "give an array of numbers"),
        (partial(qa.Recording, T, tip=np.ma.masked_array(RING)), "masked array"),
        (partial(qa.Recording, T, tip=RING[:5]), "has 400 times and 5 of tip"),
        (partial(qa.Recording, T, tip=np.zeros((400, 2, 2))), r"tip has shape \(400, 2, 2\)"),
        (partial(qa.Recording, T, tip=RING, name=3), "name is 3; give a text"),
        (partial(qa.Recording, T, tip=RING, tick="ms"), "tick is 'ms'; give a number"),
        (partial(qa.Recording, 0 * T, tip=RING), "the time stands still from row 1"),
        (partial(identify, "x", BEAM), "recordings is 'x'; give a list"),
        (partial(identify, GOOD, BEAM), r"is one recording; give a list"),
        (partial(identify, ["x"], BEAM), "a recording is 'x'"),
        (partial(identify, [GOOD], BEAM, "omega"), "free is 'omega'; give a list"),
        (partial(identify, [GOOD], BEAM, []), "free names no parameter"),
        (partial(identify, [GOOD], BEAM, parts=[(2, 1)]), "give its begin before its end"),
        (partial(identify, [GOOD], BEAM, parts=(1, 2)), "a part is 1; give"),
        (partial(identify, [GOOD], BEAM, parts=[(20, 30)]), "no part has 20 rows of it; it lasts"),
        (partial(predict, BEAM, []), "no recording is given"),
    ],
)  # fmt: skip
def test_what_is_no_recording_is_refused_in_one_line(make, said):
    with pytest.raises((ValueError, TypeError), match=said) as error:
        make()
    assert "\n" not in str(error.value)
