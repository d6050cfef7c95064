"""Any algorithm of pymoo in a search."""

import dataclasses

import pytest
from fixed_steps import rollout
from pymoo.algorithms.moo.moead import MOEAD
from pymoo.algorithms.moo.sms import SMSEMOA
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.algorithms.soo.nonconvex.nelder import NelderMead
from pymoo.operators.mutation.pm import PM
from pymoo.util.ref_dirs import get_reference_directions
from small_searches import HALF, LIMITED, assert_is_a_front

from quietarm.metaheuristics import INERTIA_2002, VEPSO, PaperNSGA2, search
from quietarm.ocp import Front


def _moead():
    return MOEAD(get_reference_directions("uniform", 2, n_partitions=9), n_neighbors=4)


OTHERS = {
    "SMSEMOA": lambda: SMSEMOA(pop_size=10),
    "MOEAD": _moead,
    "VEPSO": lambda: VEPSO(particles=5, rule=INERTIA_2002, boundary="reflect"),
}
OTHER = pytest.mark.parametrize("name", OTHERS)


@OTHER
def test_any_algorithm_of_pymoo(tmp_path, name):
    seen = []
    front = search(
        HALF, algorithm=OTHERS[name](), bound=0.5, generations=5, seed=2, report=seen.append
    )
    assert front.record.method == name
    assert len(front.points) > 0
    assert_is_a_front(front)
    assert (
        front.record.evaluations >= 50
    )  # pymoo's MOPSO-CD evaluates a second population at its start
    assert seen[-1].evaluations == front.record.evaluations == front.history[-1].evaluations
    front.save(tmp_path / "front.json")
    assert Front.load(tmp_path / "front.json") == front


def test_the_settings_of_any_algorithm_are_in_the_front():
    def settings(algorithm):
        return dict(search(HALF, algorithm=algorithm, bound=0.5, generations=2).record.settings)

    found = settings(SMSEMOA(pop_size=12, n_offsprings=3, mutation=PM(eta=30)))
    assert (found["population"], found["offspring"]) == (12, 3)
    # pymoo's defaults for SMS-EMOA, from its source
    assert found["crossover"].startswith("SBX(eta=15, ")
    assert found["mutation"] == "PM(at_least_once=False, eta=30, prob=0.9)"
    paper = settings(PaperNSGA2(12))  # docs/physics.md, 'NSGA-II settings'
    assert paper["crossover"].startswith("SBX(eta=15, ")
    assert paper["crossover"].endswith("prob=0.8, prob_bin=0.5, prob_exch=1.0, prob_var=0.5)")
    assert paper["mutation"] == "PM(at_least_once=False, eta=20, prob=1.0, prob_var=0.01)"
    other = MOEAD(0.9 * get_reference_directions("uniform", 2, n_partitions=9), n_neighbors=4)
    assert settings(_moead()) != settings(other)  # by a digest of their directions


@pytest.mark.parametrize("name", ["SMSEMOA", "VEPSO"])
def test_any_algorithm_keeps_the_limits(name):
    task = dataclasses.replace(LIMITED["nsga2"], torque_limit=0.5, jerk_limit=3000.0)
    front = search(task, algorithm=OTHERS[name](), bound=0.5, generations=6, seed=2)
    assert len(front.points) > 0
    for point in front.points:
        motion = rollout(task, front.profile, point.coefficients).motion
        assert motion.peak_acceleration <= 75.0 * (1 + 1e-6)
        assert motion.peak_torque <= 0.5 * (1 + 1e-6)
        assert motion.peak_jerk <= 3000.0 * (1 + 1e-6)


@pytest.mark.parametrize("make", [GA, NelderMead])
def test_an_algorithm_for_one_objective_is_refused_before_the_work(make):
    seen = []
    with pytest.raises(ValueError, match=f"{make.__name__} minimises one objective"):
        search(HALF, algorithm=make(), bound=0.5, generations=3, report=seen.append)
    assert seen == []
