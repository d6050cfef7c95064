"""Learning from executed moves: made-up ring-downs, and a machine with another frequency."""

from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from scipy.signal import cont2discrete, lfilter

import quietarm as qa
from quietarm.machine.identify.identified import Part
from quietarm.machine.learn.arrival_map import map_of
from quietarm.machine.learn.reading.find_start import find_start
from quietarm.machine.learn.reading.read_swing import read_swing
from quietarm.machine.learn.tip_modes import TipModes
from quietarm.machine.learn.weigh_moves import weigh_moves
from quietarm.models import LinearAxis
from quietarm.views.report.learning_rows import learning_rows, learning_sentence

AXIS = LinearAxis(omega1=2 * np.pi * 5, zeta1=0.01, mass=60.0, load=12.0, friction=40.0)
TASK = qa.PointToPoint(AXIS, target=0.5, duration=0.7)
RATE = 500
AFTER = 1.5
ARRIVAL = 1.3


@cache
def a_plan(factor=1.0):
    """A plan of four terms, whose model's frequency is so many times 5 Hz."""
    plant = replace(AXIS, omega1=factor * AXIS.omega1)
    return qa.plan_move(replace(TASK, plant=plant), qa.CycloidPolynomial(4), starts=1)


def executed(plan, *, seed=0, before=0.1, noise=1e-5, frequency=5.0, lag=0.0, offset=0.0):
    """Signals of a machine whose tip moves 1.2 times as much as the model says.

    An oscillator of its own frequency answers the set points' acceleration, which a servo delays,
    by scipy's discrete transfer function. `offset` is what each move leaves besides [m].
    """
    time = np.arange(round((before + plan.task.duration + AFTER) * RATE)) / RATE
    since = np.clip(time - before - lag, 0.0, plan.task.duration)
    inner = np.unique(np.append(since, [0.0, plan.task.duration]))
    joint = plan.sampled(inner).joint
    place, speed, acceleration = (np.interp(since, inner, column) for column in joint.T)
    moves = (since > 0) & (since < plan.task.duration)
    acceleration = acceleration * moves
    omega, zeta = 2 * np.pi * frequency, 0.01
    tops, bottom, _ = cont2discrete(([-1.0], [1.0, 2 * zeta * omega, omega**2]), 1 / RATE, "foh")
    swing = lfilter(tops[0], bottom, acceleration)
    tops, bottom, _ = cont2discrete(
        ([-1.0, 0, 0], [1.0, 2 * zeta * omega, omega**2]), 1 / RATE, "foh"
    )
    reaction = lfilter(tops[0], bottom, acceleration)
    after = np.maximum(time - before - plan.task.duration, 0.0)
    rings = offset * np.exp(-zeta * omega * after) * np.sin(omega * after)
    random = np.random.default_rng(seed)
    force = 60 * acceleration + 12 * reaction + 40 * speed + 20 * np.sign(speed)
    return {
        "time": time,
        "tip": place + 1.2 * swing + rings + random.normal(0, noise, len(time)),
        "angle": np.round(place / 1e-6) * 1e-6,
        "torque": force + random.normal(0, 1.0, len(time)),
    }


def recording(plan, *kinds, name="run", **machine):
    """A recording of some signals of an executed plan."""
    signals = executed(plan, **machine)
    return qa.Recording(signals["time"], **{kind: signals[kind] for kind in kinds}, name=name)


def left_by(plan, **machine):
    """Amplitude of the swing after a move, without noise [m]."""
    signals = executed(plan, noise=0.0, **machine)
    late = signals["tip"][signals["time"] > 0.1 + plan.task.duration + 0.1]
    return float(np.ptp(late)) / 2


# What was left


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("phase", [0.0, 1.0, -2.5])
def test_a_made_up_ring_down_has_its_amplitude_and_phase_at_arrival(phase):
    time = np.arange(0, 4, 1 / RATE)
    since = time - ARRIVAL
    omega, zeta = 2 * np.pi * 5.3, 0.02
    turns = omega * np.sqrt(1 - zeta**2) * since
    swing = 2e-3 * np.exp(-zeta * omega * since) * np.cos(turns + phase)
    noise = np.random.default_rng(0).normal(0, 2e-5, len(time))
    tip = np.where(since > 0, swing, 0.0) + 0.3 + noise

    read = read_swing(qa.Recording(time, tip=tip), ARRIVAL, AXIS, 0.5).measured

    (found,) = read.swings
    assert found.amplitude == pytest.approx(2e-3, rel=0.01)
    assert (found.phase - phase + np.pi) % (2 * np.pi) - np.pi == pytest.approx(0.0, abs=0.01)
    assert read.values["omega1"] == pytest.approx(omega, rel=1e-3)
    assert read.values["zeta1"] == pytest.approx(zeta, rel=0.05)
    error = abs(found.complex_amplitude - 2e-3 * np.exp(1j * phase))
    assert error < 5 * found.deviation  # five standard deviations


@pytest.mark.slow_after(1)
def test_what_a_servo_does_before_the_swing_is_read_counts():
    time = np.arange(0, 4, 1 / RATE)
    since = np.maximum(time - ARRIVAL, 0.0)
    settles = np.where(time > ARRIVAL, 1e-4 * np.exp(-since / 0.01), 0.0)
    noise = np.random.default_rng(0).normal(0, 1e-6, len(time))
    still, moved = (
        read_swing(qa.Recording(time, tip=tip), ARRIVAL, AXIS, 0.5)
        for tip in (noise, noise + settles)
    )
    assert still.settling < 3e-6  # noise of means
    assert 3e-5 < moved.settling < 1e-4  # their largest is at most what it begins with


@pytest.mark.slow
def test_an_accelerometer_tells_the_same_displacement():
    time = np.arange(0, 4, 1 / RATE)
    since = time - ARRIVAL
    eigenvalue = -0.01 * 31 + 31j
    swing = 2e-3 * np.exp(eigenvalue * since + 0.7j)
    acceleration = (eigenvalue**2 * swing).real  # differentiated twice
    recorded = qa.Recording(time, acceleration=np.where(since > 0, acceleration, 0.0))

    (found,) = read_swing(recorded, ARRIVAL, AXIS, 0.5).measured.swings

    assert found.amplitude == pytest.approx(2e-3, rel=1e-3)
    assert found.phase == pytest.approx(0.7, abs=2e-3)


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("seed", range(5))
def test_noise_alone_tells_no_frequency(seed):
    time = np.arange(0, 4, 1 / RATE)
    noise = np.random.default_rng(seed).normal(0, 1e-5, len(time))
    read = read_swing(qa.Recording(time, tip=noise), ARRIVAL, AXIS, 0.5)
    assert read.part is None
    assert read.measured.values == {}
    assert read.measured.swings[0].amplitude < 5e-6  # half of the noise


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("kinds", [("angle", "tip"), ("tip",), ("torque", "angle")])
def test_the_start_is_found(kinds):
    plan = a_plan()
    start = find_start(plan, recording(plan, *kinds, before=0.264))
    assert start.time == pytest.approx(0.264, abs=2e-3)  # a row
    assert start.signal == ("angle" if "angle" in kinds else "tip")


def test_modes_and_states_are_the_same_thing():
    modes = TipModes(replace(AXIS, mode_count=2, share1=0.6, share2=0.4), 0.5)
    state = modes.state(np.array([1e-3 + 2e-3j, -3e-4j]))
    assert modes.amplitudes([*state.W, *state.dW]) == pytest.approx([1e-3 + 2e-3j, -3e-4j])
    assert sum(state.W) == pytest.approx(1e-3)  # the tip is where their real parts say


def test_the_map_of_a_linear_machine_is_found_from_two_moves():
    told = np.array([0.0, 3e-3 - 1e-3j])
    left = (1.2 - 0.1j) * told + (2e-4 + 1e-4j)
    found = map_of(told, left, np.full(2, 1e-7), size=0.02)
    assert found.share == pytest.approx(1.2 - 0.1j, abs=0.02)
    assert found.deviation == pytest.approx(2e-4 + 1e-4j, abs=1e-5)
    assert found.swing(found.told_for(0.0)) == pytest.approx(0.0, abs=1e-12)


def told_by(*moves):
    """The frequency by moves, each of a value, its deviation, and the swing after it."""
    parts = [
        Part(str(k), 0.0, 1.0, {"omega1": value}, {"omega1": deviation})
        for k, (value, deviation, _) in enumerate(moves)
    ]
    return weigh_moves("omega1", parts, {str(k): swing for k, (_, _, swing) in enumerate(moves)})


# a gantry's: 12.6 mm swing after the first move, and 0.15 mm after the next
SHARP = (4.7068, 0.0016, 12.6e-3)


@pytest.mark.parametrize("deviation", [2e-4, 1.6e-3, 0.02])
@pytest.mark.parametrize("count", [1, 3])
def test_small_swings_neither_move_nor_widen_what_a_large_one_told(deviation, count):
    one = told_by(SHARP)
    both = told_by(SHARP, *[(4.719 + 0.003 * k, deviation, 0.15e-3) for k in range(count)])
    assert one.low < both.value < one.high
    assert both.high - both.low < 1.5 * (one.high - one.low)


def test_moves_of_like_swing_that_differ_are_averaged_and_unsure():
    both = told_by(SHARP, (4.719, 0.0016, 12e-3))
    assert both.value == pytest.approx(4.7129, abs=2e-3)  # the mean
    assert both.low < 4.7068
    assert both.high > 4.719
    assert both.high - both.low < 5 * 0.0122  # of what they differ by


def test_more_moves_that_agree_tell_more():
    one, four = told_by(SHARP), told_by(*[SHARP] * 4)
    assert four.value == pytest.approx(one.value)
    assert four.high - four.low < 0.6 * (one.high - one.low)  # half, by the root of four


# The next plan


@pytest.mark.slow
def test_three_moves_leave_less_than_a_fiftieth_with_another_frequency():
    machine = {"frequency": 5.4, "lag": 0.004, "offset": 3e-4}
    plan = a_plan()
    sizes = [left_by(plan, **machine)]
    for number in range(3):
        learned = qa.learn(plan, [recording(plan, "tip", "angle", seed=number, **machine)])
        plan = learned.plan
        sizes.append(left_by(plan, **machine))
    assert sizes[0] > 2e-3
    assert sizes[-1] < sizes[0] / 50
    assert all(after < 1.2 * before for before, after in pairwise(sizes))
    assert plan.task.plant.omega1 == pytest.approx(2 * np.pi * 5.4, rel=5e-3)
    assert len(plan.learned.moves) == 3
    assert plan.learned.model["omega1"] == AXIS.omega1


def test_the_first_answer_says_what_the_frequency_does():
    plan = a_plan()
    learned = qa.learn(plan, [recording(plan, "tip", "angle", frequency=5.4)])
    assert learned.left == pytest.approx(left_by(plan, frequency=5.4), rel=0.1)
    assert learned.by_frequency > 0.9 * learned.left
    assert learned.repeatable < 0.2 * learned.left
    model, new = learned.changed["omega1"]
    assert (model, new) == (AXIS.omega1, pytest.approx(2 * np.pi * 5.4, rel=5e-3))
    assert left_by(learned.plan, frequency=5.4) < learned.next_at_most
    more = learned.plan.energy / plan.energy - 1
    (note,) = learned.notes  # the correction itself takes less than 2 %
    assert note.startswith(f"the next plan takes {100 * more:+.2g} % of energy: ")


@pytest.mark.slow
def test_the_joint_and_its_torque_alone_tell_the_frequency():
    plan = a_plan()
    machine = {"frequency": 5.4}
    learned = qa.learn(plan, [recording(plan, "angle", "torque", **machine)])
    assert learned.by_joint
    _, new = learned.changed["omega1"]
    assert new == pytest.approx(2 * np.pi * 5.4, rel=5e-3)  # 0.1 to 0.4 % on machines
    assert left_by(learned.plan, **machine) < left_by(plan, **machine) / 10


@pytest.mark.slow
def test_a_torque_tells_a_damping_that_is_wrong_by_a_factor():
    model = replace(TASK, plant=replace(AXIS, zeta1=0.03))
    plan = qa.plan_move(model, qa.CycloidPolynomial(4), starts=1)
    learned = qa.learn(plan, [recording(plan, "angle", "torque", frequency=5.4)])
    assert learned.machine.plant.zeta1 == pytest.approx(0.01, abs=0.01)  # half as wrong
    assert left_by(learned.plan, frequency=5.4) < learned.next_at_most


@pytest.mark.slow
def test_a_force_in_another_unit_tells_the_same_and_is_doubted():
    plan = a_plan()
    run = recording(plan, "angle", "torque", frequency=5.4)
    right, wrong = (qa.learn(plan, [replace(run, torque=size * run.torque)]) for size in (1.0, 1e3))
    assert wrong.left == pytest.approx(right.left)
    assert not any("warning" in note for note in right.notes)
    assert any("warning: run: its torque is 9" in note for note in wrong.notes)


@pytest.mark.slow
def test_a_right_model_keeps_its_frequency_and_corrects_the_arrival():
    plan = a_plan()
    learned = qa.learn(plan, [recording(plan, "tip", "angle", offset=5e-4)])
    assert learned.changed == {}
    assert learned.plan.task.plant == plan.task.plant
    assert learned.plan.task.final is not None
    assert left_by(learned.plan, offset=5e-4) < 1e-4
    assert learned.plan.energy < 1.02 * plan.energy


@pytest.mark.slow
def test_there_is_nothing_more_to_learn_from_noise():
    plan = a_plan()
    learned = qa.learn(plan, [recording(plan, "tip", "angle")])
    assert learned.is_done
    assert learned.plan.coefficients == plan.coefficients
    assert learned.left <= learned.floor
    assert "within the floor" in learning_sentence(learned)
    again = qa.learn(learned.plan, [recording(plan, "tip", "angle", seed=1)])
    assert len(again.plan.learned.moves) == 1  # it is the same motion
    assert len(again.plan.learned.moves[0].measured) == 2


def test_what_a_plan_allows_is_nothing_to_learn_from():
    plan = qa.plan_move(TASK, qa.CycloidPolynomial(4), residual_limit=2e-4, starts=1)
    learned = qa.learn(plan, [recording(plan, "tip", "angle")])
    assert learned.floor < 1e-4 < learned.left < learned.allowed  # as far as it may, times 1.2
    assert learned.is_done
    assert learned.plan.coefficients == plan.coefficients
    assert left_by(plan) < learned.next_at_most
    assert "the move leaves what the plan allows (0.24 mm): 0.2" in learning_sentence(learned)


@cache
def a_band_plan():
    """A plan whose tip stays within 0.2 mm, for frequency errors of 5 % as well."""
    return qa.plan_move(replace(TASK, band=2e-4), qa.CycloidPolynomial(6), starts=1)


@pytest.mark.slow
@pytest.mark.parametrize("frequency", [5.0, 5.1, 5.4])
@pytest.mark.parametrize("offset", [0.0, 3e-4])
def test_what_a_plan_of_a_band_itself_leaves_is_in_the_promise(frequency, offset):
    plan, machine = a_band_plan(), {"frequency": frequency, "offset": offset}
    for number in range(3):
        run = recording(plan, "tip", "angle", seed=number, noise=2e-6, **machine)
        learned = qa.learn(plan, [run])
        assert left_by(learned.plan, **machine) < learned.next_at_most
        plan = learned.plan
        if learned.is_done:
            break
    assert learned.is_done  # it is not planned again for ever
    assert number < 2
    assert left_by(plan, **machine) < 1.05 * learned.allowed
    assert "what the plan allows (0.08" in learning_sentence(learned)
    row = dict(learning_rows(plan, learned))["tool"]
    assert row.startswith("may act after 0.")
    assert ("on this machine" in row) == (plan.task.final is not None)


@pytest.mark.slow
def test_a_next_move_that_may_leave_the_band_is_said_to():
    plan = a_band_plan()
    learned = qa.learn(plan, [recording(plan, "tip", "angle", frequency=5.4, offset=2e-3)])
    assert learned.next_at_most > 2e-4
    words = dict(learning_rows(plan, learned))["tool"]
    assert words.startswith("not sure to stay within 0.2 mm: the next move may leave 0.")


@pytest.mark.slow
def test_moves_that_differ_are_averaged_and_said_not_to_repeat():
    plan = a_plan()
    runs = [
        recording(plan, "tip", "angle", name=f"run{k}", seed=k, offset=size)
        for k, size in enumerate([8e-4, -8e-4, 2e-4])
    ]
    learned = qa.learn(plan, runs)
    assert learned.scatter > 4e-4
    assert learned.step < 0.7
    assert any("do not repeat" in note for note in learned.notes)


@pytest.mark.slow
def test_a_machine_that_changes_between_moves_is_said_to():
    plan = a_plan()
    first = qa.learn(plan, [recording(plan, "tip", "angle", frequency=5.4)])
    assert not any("changes from move to move" in note for note in first.notes)
    run = recording(first.plan, "tip", "angle", frequency=5.2, seed=1)
    second = qa.learn(first.plan, [run])
    (note,) = (note for note in second.notes if "changes from move to move" in note)
    assert "it swung at 5.2 and 5.4 Hz" in note
    assert note.endswith("by --error frequency=1.9%")  # half of 0.2 Hz in 5.3
    either = [left_by(second.plan, frequency=hertz) for hertz in (5.2, 5.4)]
    assert max(either) < second.next_at_most  # either frequency may be the next


@pytest.mark.slow
def test_a_plan_with_a_history_loads_to_an_equal_value(tmp_path):
    plan = a_plan()
    learned = qa.learn(plan, [recording(plan, "tip", "angle", frequency=5.2)])
    learned.plan.save(tmp_path / "next.json")
    loaded = qa.Plan.load(tmp_path / "next.json")
    assert loaded == learned.plan
    assert loaded.learned == learned.plan.learned
    plan.save(tmp_path / "plain.json")
    assert "learned" not in (tmp_path / "plain.json").read_text()


@pytest.mark.slow
def test_what_was_learned_is_a_machine():
    plan = a_plan()
    machine = qa.learn(plan, [recording(plan, "tip", "angle", frequency=5.4)]).machine
    assert machine.plant.omega1 == pytest.approx(2 * np.pi * 5.4, rel=1e-3)
    assert machine.plant.mass == AXIS.mass
    assert [one.parameter for one in machine.estimates] == ["omega1", "zeta1"]


# What is refused


def cut(recorded, end):
    """A recording until a time [s]."""
    return recorded.part(recorded.rows(0.0, end))


def stretched(recorded, factor):
    """Return the recording by a clock that runs so much slower."""
    return replace(recorded, time=factor * recorded.time)


def clipped(recorded, most):
    """Return the recording by a sensor that sees so far from the target alone [m]."""
    return replace(recorded, tip=np.clip(recorded.tip, 0.5 - most, 0.5 + most))


@pytest.mark.slow_after(5)
@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda run: stretched(run, 1e3), r"it lasts 2298 s with .* give --units time:ms"),
        (lambda run: cut(run, 0.95), r"it is too short: it ends 0\.7\d periods after arrival"),
        (lambda run: cut(run, 0.5), r"it lasts 0\.5 s, and the move of the plan 0\.7 s"),
        (lambda run: stretched(run, 1.05), r"its clock is off: the move takes 0\.735 s there"),
        (lambda run: stretched(run, 2.0), r"its clock is off: the move takes 1\.\d+ s there"),
        (lambda run: run.part(slice(None, None, 40)), "samples a second of a swing of 5 Hz"),
        (lambda run: replace(run, angle=0.5 * run.angle), "its joint goes 250 mm, and that of"),
        (lambda run: replace(run, angle=-run.angle), "it is of another move"),
        (lambda run: replace(run, tip=1e3 * run.tip), r"its tip goes 5\d\d\.?\d* m, .* tip:mm"),
        (lambda run: replace(run, tip=1e-3 * run.tip), r"its tip goes 0\.000\d+ m, .* tip:m,"),
        (lambda run: clipped(run, 5e-4), "of its samples after arrival are at the sensor's limit"),
    ],
)
def test_a_recording_that_tells_nothing_is_refused_in_a_line(change, words):
    plan = a_plan()
    run = change(recording(plan, "tip", "angle", frequency=5.4))
    with pytest.raises(ValueError, match=words) as refused:
        qa.learn(plan, [run])
    assert str(refused.value).startswith("run: ")
    assert "; " in str(refused.value)  # a remedy


def test_a_tip_in_place_of_the_joint_is_refused():
    plan = a_plan()
    signals = executed(plan, frequency=5.4)
    swapped = qa.Recording(signals["time"], tip=signals["angle"], angle=signals["tip"], name="run")
    words = (
        r"run: its joint still swings by 4\.\d mm at 5\.\d+ Hz after arrival, and its tip by 0 mm"
    )
    with pytest.raises(ValueError, match=rf"{words}; were --tip and --angle exchanged\?$"):
        qa.learn(plan, [swapped])


def test_a_tip_that_swings_little_in_place_of_the_joint_is_refused_as_well():
    plan = a_plan()
    signals = executed(plan)  # by the model's own frequency, so that hardly a swing is left
    swapped = qa.Recording(signals["time"], tip=signals["angle"], angle=signals["tip"], name="run")
    with pytest.raises(ValueError, match=r"; were --tip and --angle exchanged\?$") as refused:
        qa.learn(plan, [swapped])
    assert "its tip follows the path of the plan's joint" in str(refused.value)


def another_path(duration, *, power):
    """A recording of a joint that goes the plan's way in some time by another path."""
    time = np.arange(round(2.2 * RATE)) / RATE
    since = np.clip((time - 0.1) / duration, 0.0, 1.0)
    half = 0.5 * np.minimum(2 * since, 2 - 2 * since) ** power
    way = 0.5 * np.where(since < 0.5, half, 1 - half)
    noise = np.random.default_rng(0).normal(0, 1e-5, len(time))
    return qa.Recording(time, angle=way, tip=way + noise, name="run")


@pytest.mark.parametrize("power", [1, 5, 9])
def test_another_path_of_the_same_way_is_said_to_be_one(power):
    with pytest.raises(ValueError, match="it is of another move: ") as refused:
        qa.learn(a_plan(), [another_path(0.7, power=power)])
    assert "--units" not in str(refused.value)
    assert "another path" in str(refused.value) or "the plan explains" in str(refused.value)


@cache
def another_plan(kind):
    """The plan of another move, or another plan of the same one."""
    if kind == "terms":
        return qa.plan_move(TASK, qa.CycloidPolynomial(6), starts=1)
    if kind == "model":
        return a_plan(0.92)
    if kind == "cycloid":
        return qa.evaluate_coefficients(TASK, [0.0], profile=qa.CycloidPolynomial(1))
    return qa.plan_move(replace(TASK, target=0.51), qa.CycloidPolynomial(4), starts=1)


def as_seen(signals, kinds):
    """A recording of some signals; a displacement is the tip beside the joint."""
    seen = dict(signals, displacement=signals["tip"] - signals["angle"])
    return qa.Recording(
        seen["time"],
        **{"tip" if kind == "displacement" else kind: seen[kind] for kind in kinds},
        name="run",
    )


WRONG = [
    ("model", ("tip",)),
    ("terms", ("tip",)),
    ("cycloid", ("tip",)),
    ("way", ("tip",)),
    ("terms", ("displacement",)),
    ("model", ("tip", "angle")),
    ("cycloid", ("angle", "torque")),
    ("way", ("tip", "angle")),
]


@pytest.mark.slow_after(2)
@pytest.mark.parametrize(("kind", "signals"), WRONG)
def test_the_recording_of_another_plan_is_refused(kind, signals):
    run = as_seen(executed(another_plan(kind), frequency=5.4), signals)
    with pytest.raises(ValueError, match=r"^run: it is of another move: .*; give the recording of"):
        qa.learn(a_plan(), [run])


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("factor", [-1.0, 0.1, 10.0])
def test_a_tip_that_goes_another_way_or_in_another_unit_is_refused(factor):
    signals = executed(a_plan(), frequency=5.4)
    run = as_seen(dict(signals, tip=factor * signals["tip"]), ["tip"])
    with pytest.raises(ValueError, match=r"^run: it is of another move: "):
        qa.learn(a_plan(), [run])


@pytest.mark.slow
def test_a_still_plan_is_kept_where_no_tip_is_seen():
    plan = a_plan()
    learned = qa.learn(plan, [recording(plan, "angle", "torque", frequency=5.005, lag=0.004)])
    assert learned.is_done
    assert learned.plan.coefficients == plan.coefficients
    assert learned.left <= learned.floor
    assert "within the floor" in learning_sentence(learned)


def test_a_torque_alone_is_refused():
    with pytest.raises(ValueError, match="a torque alone does not tell how the tip swings"):
        qa.learn(a_plan(), [recording(a_plan(), "torque")])


@pytest.mark.slow
def test_a_recording_of_an_earlier_plan_is_refused():
    plan = a_plan()
    first = recording(plan, "tip", "angle", frequency=5.4)
    learned = qa.learn(plan, [first])
    with pytest.raises(ValueError, match="it is of move 1, which an earlier plan made"):
        qa.learn(learned.plan, [first])


def test_a_plan_of_one_motion_is_refused():
    plan = qa.evaluate_coefficients(TASK, [], profile=qa.shaped_cycloid(TASK, "zv"))
    with pytest.raises(ValueError, match="has one motion alone, and nothing to change"):
        qa.learn(plan, [recording(a_plan(), "tip")])


# What swings


@pytest.mark.slow
def test_a_torque_tells_a_heavier_payload_from_a_softer_structure():
    lighter = replace(TASK, plant=replace(AXIS, load=10.0))  # of 12 kg that swing on the machine
    plan = qa.plan_move(lighter, qa.CycloidPolynomial(4), starts=1)
    for signals in (("angle", "torque"), ("tip", "angle", "torque")):
        learned = qa.learn(plan, [recording(plan, *signals, frequency=4.8)])
        swings, moves = learned.inertias
        assert swings.value == pytest.approx(1.2, abs=0.03)  # 12 of 10 kg
        assert swings.low < 1.2 < swings.high
        assert moves.value == pytest.approx(1.0, abs=0.01)
        assert any(name == "what swings" for name, _ in learning_rows(plan, learned))
    assert qa.learn(plan, [recording(plan, "tip", "angle", frequency=4.8)]).inertias == ()
