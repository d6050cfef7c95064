"""What is no front, no plan and no list of them is refused in a line, with the value."""

from dataclasses import replace
from functools import partial

import pytest
from matplotlib.figure import Figure
from quietarm.ocp import Polish, evaluate_robustness
from quietarm.studies import figures


@pytest.mark.parametrize(
    ("draw", "given", "message"),
    [
        (figures.draw_fronts, [5], "front 1 is 5; give a Front, as of"),
        (figures.draw_fronts, 5, "fronts is 5; give a list of fronts"),
        (figures.draw_fronts, [], "there is no front to draw; give"),
        (figures.draw_hypervolume, [None], "front 1 is None; give a Front"),
        (figures.draw_seed_energies, "ab", "front 1 is 'a'; give a Front"),
        (figures.front_figure, [], "there is no front to draw; give"),
        (figures.draw_sweep, [5], r"front is \[5\]; give a Front"),
        (figures.sweep_figure, 5, "front is 5; give a Front"),
        (figures.robustness_figure, [5], r"plans is \[5\]; give figures of robustness by label"),
        (figures.robustness_figure, {}, "there is no plan to draw; give"),
        (figures.robustness_figure, {"rest": 5}, "plan 'rest' is 5; give what"),
        (figures.motion_figure, [5], "motion 1 is 5; give a Line"),
        (figures.motion_figure, 5, "motions is 5; give a Plan"),
        (figures.motion_figure, [], "give one motion or more"),
        (figures.compare_fronts, [5, 6], "front 1 is 5; give a Front"),
        (figures.comparison_figure, 5, "comparison is 5; give what compare_fronts returns"),
    ],
)
def test_what_is_something_else_is_refused_in_a_line(draw, given, message):
    with pytest.raises(ValueError, match=message) as refused:
        draw(given)
    assert "\n" not in str(refused.value)


def test_of_a_front_and_what_polishing_gained_both_are_looked_at(good):
    for draw in (figures.draw_polish, figures.draw_savings, figures.polish_figure):
        with pytest.raises(ValueError, match="front is 5; give a Front"):
            draw(5, good)
        with pytest.raises(ValueError, match=r"polish is .*; give what ocp.polish_front returns"):
            draw(good, good)


def test_a_sweep_that_a_plan_does_not_have_is_named(plan):
    ranges = {"frequency": 0.1}
    found = evaluate_robustness(plan.task, plan.profile, plan.coefficients, ranges, samples=1)
    with pytest.raises(ValueError, match="plan 'rest' has no sweep of 'frequenzy'; did you mean"):
        figures.draw_robustness({"rest": found}, "frequenzy")


@pytest.mark.parametrize("kind", ["figure", "several", "number"])
def test_what_is_no_axes_is_refused_in_a_line(plan, good, kind):
    ax = {"figure": Figure(), "several": Figure().subplots(2, 2), "number": 5}[kind]
    for draw in (
        partial(figures.draw_fronts, [good]),
        partial(figures.draw_quantity, plan, "speed"),
    ):
        with pytest.raises(ValueError, match=r"^ax is .*; give one Axes, as") as refused:
            draw(ax=ax)
        assert "\n" not in str(refused.value)


@pytest.mark.parametrize("draw", [figures.draw_polish, figures.draw_savings])
def test_a_polish_of_another_task_is_refused(draw, good):
    other = replace(good, task=replace(good.task, target=1.0))
    with pytest.raises(ValueError, match="polish is of another task than the front: give what"):
        draw(other, Polish(good, ()))


@pytest.mark.parametrize("draw", [figures.draw_seed_energies, figures.draw_hypervolume])
def test_seeds_are_of_one_task(draw, good):
    other = replace(good, task=replace(good.task, target=1.0))
    with pytest.raises(ValueError, match="front 2 is of another task than front 1: give what was"):
        draw([good, other])
