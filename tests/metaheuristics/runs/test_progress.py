"""The history of a search, its reports, and Ctrl-C."""

import signal
import threading

import numpy as np
import pytest
from quietarm.metaheuristics import PopulationObjective, search
from quietarm.metaheuristics.objective.population import CANDIDATE_STEPS
from quietarm.ocp import CycloidPolynomial, Front, PointToPoint, rollout
from small_searches import (
    METHODS,
    SINGLE_LINK,
    SWARMS,
    assert_is_a_front,
    exactly,
    found,
    run,
    stop_after,
)

# -- history and reports --


@METHODS
@pytest.mark.parametrize(("population", "generations"), [(20, 15), (7, 3), (2, 1), (201, 2)])
def test_evaluations_are_exact(monkeypatch, method, population, generations):
    asked = []
    evaluate = PopulationObjective.__call__

    def counting(self, coefficients):
        if self.steps == CANDIDATE_STEPS:  # not the finer one, for the points of the front
            asked.append(len(coefficients))
        return evaluate(self, coefficients)

    monkeypatch.setattr(PopulationObjective, "__call__", counting)
    front = run(method, population=population, generations=generations)
    each = SWARMS[method] * population
    assert sum(asked) == front.evaluations == each * generations
    expected = [each * (k + 1) for k in range(generations)]
    assert [entry.evaluations for entry in front.history] == expected


def _hypervolume(front):
    """Share of the reference box by a sweep along the front."""
    inside = (front.residuals < front.reference[0]) & (front.energies < front.reference[1])
    F = np.column_stack([front.residuals, front.energies])[inside] / front.reference
    right = np.append(F[1:, 0], 1.0)
    return float(((right - F[:, 0]) * (1.0 - F[:, 1])).sum())


@METHODS
def test_hypervolume_by_generation(method):
    front = found(method)
    assert len(front.history) == 15
    shares = [entry.hypervolume for entry in front.history]
    assert 0 <= min(shares) < max(shares) < 1
    # the search's steps are coarser than those of the figures in the front: 1e-4 in energy
    assert shares[-1] == pytest.approx(_hypervolume(front), rel=1e-3)


@pytest.mark.parametrize("seed", range(3))
def test_the_hypervolume_of_vepsos_archive_never_falls(seed):
    shares = [entry.hypervolume for entry in found("vepso", seed=seed).history]
    assert np.all(np.diff(shares) >= 0)
    assert shares[-1] > shares[0]


def test_a_plain_cycloid_that_is_still_leaves_a_reference_of_a_millimetre():
    slow = PointToPoint(SINGLE_LINK, 0.001, 5.0)
    assert rollout(slow, CycloidPolynomial(0), []).motion.residual < 1e-6
    front = search(slow, "nsga2", bound=0.05, population=20, generations=15)
    assert front.reference[0] == 1e-3
    assert 0 < front.history[-1].hypervolume < 1


def test_the_reference_is_the_residual_of_the_plain_cycloid_and_twice_its_energy():
    # docs/physics.md: max |W| 3.382e-2 m (times phi) and 0.09115 J; 2.947e-2 m and 0.12457 J.
    assert found("vepso").reference == pytest.approx((2.28 * 3.382e-2, 2 * 0.09115), rel=2e-4)
    assert found("nsga2").reference == pytest.approx((0.508 * 2.947e-2, 2 * 0.12457), rel=2e-4)


@METHODS
def test_a_report_comes_after_every_generation(method):
    seen = []
    front = run(method, report=seen.append)
    assert exactly(front) == exactly(found(method))
    assert [progress.generation for progress in seen] == list(range(1, 16))
    assert {progress.generations for progress in seen} == {15}
    assert [p.evaluations for p in seen] == [entry.evaluations for entry in front.history]
    assert [p.hypervolume for p in seen] == [entry.hypervolume for entry in front.history]
    assert np.all(np.diff([progress.seconds for progress in seen]) >= 0)
    assert seen[-1].residual == pytest.approx(front.stillest().residual, rel=1e-3)
    assert seen[-1].energy == pytest.approx(front.cheapest().energy, rel=1e-3)
    for name in ("residual", "energy"):
        values = [getattr(progress, name) for progress in seen]
        assert values == sorted(values, reverse=True)  # the extremes of a front are kept


# -- Ctrl-C --


@METHODS
@pytest.mark.parametrize("stop", [1, 6, 15])
def test_ctrl_c_keeps_what_was_found(tmp_path, method, stop):
    front = run(method, report=stop_after(stop))
    assert not front.complete
    assert len(front.history) == stop
    assert front.history == found(method).history[:stop]
    assert front.evaluations == SWARMS[method] * 20 * stop
    assert len(front.points) > 0
    assert_is_a_front(front)
    front.save(tmp_path / "front.json")
    loaded = Front.load(tmp_path / "front.json")
    assert loaded == front
    assert not loaded.complete


@METHODS
def test_an_interrupt_before_anything_was_found_gives_an_empty_front(monkeypatch, method):
    def interrupted(self, coefficients):
        if len(coefficients):
            raise KeyboardInterrupt
        return evaluate(self, coefficients)

    evaluate = PopulationObjective.__call__
    monkeypatch.setattr(PopulationObjective, "__call__", interrupted)
    front = run(method)
    assert (front.points, front.history, front.complete) == ((), (), False)


@METHODS
@pytest.mark.parametrize("times", [1, 2])
def test_ctrl_c_while_the_front_is_worked_out_loses_nothing(tmp_path, monkeypatch, method, times):
    evaluate, interrupted = PopulationObjective.__call__, []

    def interrupting(self, coefficients):
        if self.steps != CANDIDATE_STEPS:
            interrupted.append(1)
            for _ in range(times):
                signal.raise_signal(signal.SIGINT)
        return evaluate(self, coefficients)

    path = tmp_path / "checkpoint"
    with monkeypatch.context() as patch:
        patch.setattr(PopulationObjective, "__call__", interrupting)
        front = run(method, checkpoint=path)
    assert interrupted
    assert not front.complete  # the caller is told, as by a Ctrl-C in the last generation
    assert front.points == found(method).points
    assert front.history == found(method).history
    assert exactly(run(method, resume=path)) == exactly(found(method))


@METHODS
@pytest.mark.parametrize("moment", range(4))
@pytest.mark.skipif(not hasattr(signal, "pthread_kill"), reason="Ctrl-C is sent as a signal")
def test_ctrl_c_at_any_moment(method, moment):
    delay = np.random.default_rng(moment).uniform(0.001, 0.1)
    main = threading.main_thread().ident
    timer = threading.Timer(delay, lambda: signal.pthread_kill(main, signal.SIGINT))

    def begin(progress):
        if progress.generation == 1:
            timer.start()
        if progress.seconds > 300:
            raise RuntimeError("the search went on after Ctrl-C")

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        front = run(method, generations=100_000, report=begin)
        timer.join()
    finally:
        timer.cancel()
        signal.signal(signal.SIGINT, before)
    assert not front.complete
    assert 1 <= len(front.history) < 100_000
    assert len(front.points) > 0
    assert_is_a_front(front)
    for point in front.points[:3]:
        motion = rollout(front.task, front.profile, point.coefficients).motion
        assert point.energy == pytest.approx(motion.energy, rel=1e-12)
