"""Every method that is known by name, at work on both of the paper's plants."""

import dataclasses
import itertools

import pytest
from small_searches import HALF, LIMITED, SIXTH, assert_is_a_front, exactly

from quietarm.metaheuristics import PRESETS, search
from quietarm.metaheuristics.methods.presets import preset_of

SMALL = {"population": 8, "generations": 4, "bound": 0.3}
SEARCHES = [name for name, preset in PRESETS.items() if not preset.is_function]
IN_TURN = list(zip(SEARCHES, itertools.cycle([SIXTH, HALF])))
KEEPS_LIMITS = [name for name, preset in PRESETS.items() if preset.keeps_limits]


@pytest.mark.slow_after(2)
@pytest.mark.parametrize(("name", "task"), IN_TURN)
def test_the_seed_decides_about_the_front(name, task):
    one, same, other = (search(task, algorithm=name, seed=seed, **SMALL) for seed in (2, 2, 3))
    assert exactly(one) == exactly(same)
    assert one.points != other.points
    assert_is_a_front(one)
    assert (one.record.method, len(one.history)) == (name, 4)
    # a population and a generation mean the same for all
    wanted = (2 if preset_of(name).by_swarms else 1) * 8 * 4
    assert one.record.evaluations == wanted == preset_of(name).evaluations(8, 4)
    steps = [entry.evaluations for entry in one.history]
    assert steps == [wanted // 4 * generation for generation in range(1, 5)]


@pytest.mark.parametrize("name", sorted(set(PRESETS) - set(KEEPS_LIMITS)))
def test_a_method_that_passes_over_limits_refuses_them(name):
    with pytest.raises(ValueError, match=f"{name} cannot search a task with limits; "):
        search(LIMITED["nsga2"], algorithm=name, **SMALL)


def test_what_a_run_leaves_does_not_change_the_next():
    # pymoo's SPEA2 keeps the scale of its first run in a default argument
    first = search(HALF, algorithm="spea2", seed=2, **SMALL)
    search(dataclasses.replace(HALF, duration=2.0), algorithm="spea2", seed=2, **SMALL)
    assert exactly(search(HALF, algorithm="spea2", seed=2, **SMALL)) == exactly(first)
