"""Every public function that takes a task, profile, plant, front or the like says what to give."""

import dataclasses
import inspect
import re

import numpy as np
import pytest

import quietarm as qa
from quietarm.interrupts import is_interruptible
from quietarm.models import LinearAxis
from quietarm.models.compiled import Compiled

# Of these classes; `Motions` is what the pictures of motions take.
KINDS = (
    "PointToPoint", "JointProfile", "Plant", "Energy", "Solver", "Front", "Plan", "Floor",
    "Motions", "JudgedMotion",
)  # fmt: skip
WRONG = {
    "PointToPoint": ("link", "'link'; give a task, such as PointToPoint(SingleLinkManipulator(), "),
    "JointProfile": ("spline", "'spline'; give an object, such as CycloidSpline()"),
    "Plant": ("single_link", "'single_link'; give an object, such as SingleLinkManipulator()"),
    "Energy": ("copper", "'copper'; give an object, such as CopperLoss(motor_constant)"),
    "Solver": ("ipopt", "solver is 'ipopt'; give an object, such as Ipopt()"),
    "Front": ("front.json", "'front.json'; give Front.load('front.json')"),
    "Plan": ("plan.json", "'plan.json'; give Plan.load('plan.json')"),
    "Floor": ("floor.json", "'floor.json'; give Floor.load('floor.json')"),
    "JudgedMotion": (
        "plan.json",
        "'plan.json'; give a motion, such as plan.candidate or JudgedMotion.of_p",
    ),
    "Motions": (["plan.json"], "'plan.json'; give a line, such as Line(plan, 'plan')"),
}


def _kind_of(annotation):
    """The class of `KINDS` that an annotation names, and whether it is of many."""
    for kind in KINDS:
        if re.fullmatch(
            rf"(?:(?:Sequence|Mapping)\[(?:str, )?)?{kind}\]?(?: \| None| \| list\[.*)?", annotation
        ):
            return kind, "[" in annotation
    return None, False


def _public():
    """Return what every package, and every room of `studies` that users call, gives by name."""
    homes = [qa.models, qa.ocp, qa.metaheuristics, qa.pictures, qa.compare, qa.bench]
    homes += [qa.machine.identify, qa.machine.learn, qa.studies.sweep]
    return {name: getattr(home, name) for home in homes for name in dir(home)}


def _doors():
    """Public functions, classes that are no answers, and class methods, with such an argument."""
    for name, public in sorted(_public().items()):
        if not callable(public):
            continue
        made_by_hand = not hasattr(public, "__dataclass_fields__") or public is qa.PointToPoint
        callables = {name: public} if made_by_hand else {}
        if inspect.isclass(public):
            for method, value in vars(public).items():
                if isinstance(value, classmethod) and not method.startswith("_"):
                    callables[f"{name}.{method}"] = getattr(public, method)
        for label, function in callables.items():
            try:
                parameters = inspect.signature(function).parameters.values()
            except ValueError:
                continue
            for parameter in parameters:
                kind, many = _kind_of(str(parameter.annotation))
                if kind is not None and label not in ANSWERS:
                    yield pytest.param(function, parameter.name, kind, many,
                                       id=f"{label}-{parameter.name}")  # fmt: skip


# Made by quietarm alone.
ANSWERS = {"Figures", "Trajectory.from_outputs", "LostJobsError", "Results.of_jobs"}
DOORS = list(_doors())


@pytest.fixture(scope="module")
def right():
    """Arguments that are right, by name; those of no class are never looked at."""
    link = qa.SingleLinkManipulator()
    task = qa.PointToPoint(link, 0.5236, 0.8)
    return {
        "task": task, "one": task, "other": task, "tasks": [task], "plant": link,
        "profile": qa.CycloidPolynomial(1), "coefficients": [0.0], "target": 0.5, "duration": 0.8,
        "plans": {}, "fronts": [], "quantity": "speed", "floor": object.__new__(qa.ocp.Floor),
        "front": object.__new__(qa.Front), "plan": object.__new__(qa.Plan),
    }  # fmt: skip


def test_the_doors_are_found():
    names = {door.id for door in DOORS}
    assert {
        "plan_move-task", "plan_move-profile", "plan_moves-tasks", "fastest_move-profile",
        "plan_move-solver", "polish_front-solver", "sweep-solver",
        "epsilon_front-task", "weighted_front-profile", "search-start", "sweep-profile",
        "evaluate_coefficients-task", "energy_floor-task", "cross_check-front",
        "polish_front-front", "shaped_cycloid-task", "evaluate_robustness-candidate",
        "JudgedMotion.of_profile-profile", "PointToPoint-plant", "PointToPoint-energy",
        "motion_figure-motions",
    } <= names  # fmt: skip


@pytest.mark.parametrize(("function", "name", "kind", "many"), DOORS)
def test_something_else_is_told_what_to_give(right, function, name, kind, many):
    wrong, told = WRONG[kind]
    given = {
        parameter.name: right.get(parameter.name)
        for parameter in inspect.signature(function).parameters.values()
        if parameter.name == name
        or (parameter.default is parameter.empty and parameter.kind is not parameter.VAR_KEYWORD)
    }
    values = {"a": wrong} if name == "plans" else [wrong]
    given[name] = values if many and kind != "Motions" else wrong
    with pytest.raises(TypeError) as error:
        function(**given)
    assert told in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("profile", "told"),
    [
        (6, "profile is 6; give a profile, such as CycloidPolynomial(6) or CycloidSpline(12)"),
        (qa.CycloidSpline, "profile is CycloidSpline; give an object, such as CycloidSpline()"),
        (
            qa.ocp.ShapedCycloid,
            "give an object, such as ShapedCycloid(shaper, frequencies, damping_ratios)",
        ),
        ("cycloid-spline", "give an object, such as CycloidSpline()"),
        ([0.1, 0.2], "profile is [0.1, 0.2]; give a profile, such as"),
    ],
)
def test_a_profile_is_an_object(right, profile, told):
    with pytest.raises(TypeError) as error:
        qa.plan_move(right["task"], profile)
    assert told in str(error.value)


@pytest.mark.parametrize(
    ("field", "value", "told"),
    [
        (
            "initial",
            (0.01, 0),
            "initial is (0.01, 0); give a state, such as ModalState(W=[0.01], dW=[0",
        ),
        (
            "final",
            [0.01, 0],
            "final is [0.01, 0]; give a state, such as ModalState(W=[0.01], dW=[0.0])",
        ),
        (
            "energy",
            None,
            "energy is None; give an energy, such as AbsolutePower() or CopperLoss(0.12)",
        ),
        ("energy", qa.ocp.PositivePower, "give an object, such as PositivePower()"),
        ("uncertainty", {"frequency": 0.1}, "give ranges, such as Uncertainty({'frequency': 0.1})"),
        ("uncertainty", 0.1, "uncertainty is 0.1; give ranges, such as Uncertainty("),
    ],
)
def test_a_field_of_a_task_is_of_its_class(field, value, told):
    with pytest.raises(TypeError) as error:
        qa.PointToPoint(qa.SingleLinkManipulator(), 0.5236, 0.8, **{field: value})
    assert told in str(error.value)


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (
            lambda: qa.ocp.ModalState(0.01, 0),
            r"W is 0.01; give a list of numbers, one for each mode",
        ),
        (lambda: qa.Uncertainty(0.1), r"errors are 0.1; give them by name, such as "
                                      r"{'frequency': 0.1}"),
        (lambda: qa.Uncertainty("frequency"), "errors are 'frequency'; give them by name"),
        (
            lambda: qa.PointToPoint(qa.SingleLinkManipulator(), 0.5, 0.8, torque_speed=1.5),
            r"torque-speed line is 1.5; give .* as \[\(1.5, 0\), \(0.8, 20\)\]",
        ),
        (
            lambda: qa.PointToPoint(qa.SingleLinkManipulator(), 0.5, 0.8, torque_speed=[1.5, 20]),
            r"torque-speed line is .*; give .* as \[\(1.5, 0\), \(0.8, 20\)\]",
        ),
    ],
)  # fmt: skip
def test_numbers_stand_in_lists_and_by_names(make, told):
    with pytest.raises(ValueError, match=told):
        make()


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda task: qa.search(task, "nsga2", bound=0.2), "a method is given as algorithm=..."),
        (lambda task: qa.motion_figure("plan.json"), "give Plan.load('plan.json')"),
        (lambda task: qa.motion_figure(6), "give a plan, such as Plan.load('plan.json')"),
        (lambda task: qa.pictures.draw_quantity([], "sped"), "did you mean 'speed'?"),
        (
            lambda task: qa.plan_move(task, guess="a"),
            "coefficients are 'a'; give a list of numbers",
        ),
        (lambda task: qa.epsilon_front(task, at=0.1), "at is 0.1; give a list of residuals"),
        (lambda task: qa.weighted_front(task, weights=0.3), "give pairs of residual and energy"),
        (lambda task: qa.ocp.perturb_plant(task.plant, 0.1), "by name, such as {'frequency': 0.1}"),
        (lambda task: qa.sweep(task, axes={"target": 0.1}, path="x.zarr"), "give a list of values"),
        (
            lambda task: qa.compare.compare_plans([task]),
            "give them by name, such as {'mine': plan}",
        ),
        (lambda task: qa.compare.compare_plans({}, "zv", task=task), "give a list of names"),
        (lambda task: qa.ocp.ShapedCycloid("zv", 10.0, [0.1]), "frequencies is 10.0; give a list"),
    ],
)
def test_other_arguments_say_so_as_well(right, call, told):
    with pytest.raises((TypeError, ValueError), match=re.escape(told)):
        call(right["task"])


def test_one_move_is_no_list_of_moves(right):
    with pytest.raises(TypeError, match="give a list of objects of PointToPoint"):
        qa.plan_moves(right["task"])


def test_an_energy_adds_to_energies_alone():
    with pytest.raises(TypeError, match="part of a mix is 3; give an energy, such as"):
        qa.ocp.Mix(((1.0, qa.AbsolutePower()), (1.0, 3)))


def test_an_argument_that_is_not_known_is_pythons_own_error(right):
    with pytest.raises(TypeError, match=r"plan_move.* got an unexpected keyword argument 'terms'"):
        qa.plan_move(right["task"], terms=6)


NUMBERS = {
    "bound": (
        qa.plan_move,
        qa.epsilon_front,
        qa.weighted_front,
        qa.search,
        qa.metaheuristics.MoveFunction,
    ),
    "residual_limit": (qa.plan_move,),
    "starts": (qa.plan_move, qa.epsilon_front, qa.energy_floor),
    "seed": (qa.plan_move, qa.epsilon_front, qa.search),
    "steps": (qa.plan_move, qa.metaheuristics.MoveFunction),
    "points": (qa.epsilon_front, qa.weighted_front),
}


@pytest.mark.parametrize("value", ["0.2", True, False, np.True_])
@pytest.mark.parametrize(
    ("function", "name"),
    [(function, name) for name, functions in NUMBERS.items() for function in functions],
)
def test_text_and_truth_values_are_no_numbers(right, function, name, value):
    settings = {"profile": qa.CycloidPolynomial(2), "bound": 0.2, name: value}
    known = inspect.signature(function).parameters
    with pytest.raises(ValueError, match=r" is .*; give a (whole )?number"):
        function(right["task"], **{key: settings[key] for key in settings if key in known})


TASK_NUMBERS = [
    entry.name
    for entry in dataclasses.fields(qa.PointToPoint)
    if entry.name in ("start", "target", "duration", "residual_window") or "_limit" in entry.name
]


@pytest.mark.parametrize("value", ["0.8", True])
@pytest.mark.parametrize("name", TASK_NUMBERS)
def test_so_is_no_entry_of_a_task(name, value):
    move = {"target": 0.5, "duration": 0.8, name: value}
    with pytest.raises(ValueError, match=f"is {value!r}; give a number"):
        qa.PointToPoint(qa.SingleLinkManipulator(), **move)


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: qa.deg("30"), "degrees are '30'; give a number, such as deg(30)"),
        (lambda: qa.JointSpline(25), "knots is 25; give a list of fractions, such as [0.3, 0.7]"),
        (lambda: qa.CycloidSpline(True), "terms is True; give a whole number"),
        (
            lambda: qa.pictures.Line(3, "x"),
            "plan is 3; give a plan, such as Plan.load('plan.json')",
        ),
        (lambda: qa.Uncertainty({"frequency": "0.1"}), "is '0.1'; give a number"),
        (lambda: qa.CopperLoss("0.1"), "motor constant is '0.1'; give a number"),
        (lambda: qa.ocp.ModalState(["0.1"], [0]), "is '0.1'; give a number"),
        (lambda: qa.models.load_plant_file(3), "path is 3; give the name of a Python file"),
    ],
)
def test_what_is_made_of_something_else_says_what_to_give(make, told):
    with pytest.raises((TypeError, ValueError), match=re.escape(told)):
        make()


@pytest.mark.parametrize("kind", [qa.Plan, qa.Front, qa.ocp.Floor])
@pytest.mark.parametrize("path", [3, None, ["plan.json"]])
def test_a_file_has_a_name(right, kind, path):
    with pytest.raises(TypeError, match=r"; give the name of a file, such as 'plan\.json'"):
        kind.load(path)
    plan = qa.evaluate_coefficients(right["task"], [0.1])
    for save in (plan.save, plan.save_csv):
        with pytest.raises(TypeError, match=r"; give the name of a file, such as 'plan\.json'"):
            save(path)


def test_a_plan_in_a_list_is_named_as_short_as_a_line(right):
    plan = qa.evaluate_coefficients(right["task"], [0.1])
    told = "motion 1 is an object of Plan; give a line, such as Line(plan, 'plan')"
    with pytest.raises(TypeError, match=re.escape(told)):
        qa.motion_figure([plan])


@pytest.mark.parametrize("coefficients", [["0.1"], [True], "ab"])
def test_coefficients_are_numbers(right, coefficients):
    with pytest.raises(ValueError, match="; give a list of numbers"):
        qa.evaluate_coefficients(right["task"], coefficients)


def test_a_notebook_shows_what_a_robust_plan_is_worth():
    task = qa.PointToPoint(
        qa.SingleLinkManipulator(), 0.5236, 0.8, torque_limit=0.5,
        torque_speed=[(1.5, 0), (0.8, 20)], uncertainty=qa.Uncertainty({"frequency": 0.08}),
    )  # fmt: skip
    plan = qa.evaluate_coefficients(task, [0.01])
    shown = plan._repr_html_()
    assert "<td>parameter errors</td><td>frequency +-8 %</td>" in shown
    worst = f"{plan.worst.residual:.3g} m with frequency "
    assert f"<td>worst-case residual</td><td>{worst}" in shown
    assert "<td>limits</td><td>torque 0.5 N m, torque-speed 1.5Nm@0,0.8Nm@20</td>" in shown


def test_a_notebook_shows_forces_of_a_linear_axis():
    task = qa.PointToPoint(LinearAxis(), 0.3, 0.8, torque_limit=90.0)
    shown = qa.evaluate_coefficients(task, [0.01])._repr_html_()
    assert "<td>limits</td><td>force 90 N</td>" in shown
    assert re.search(r"<td>peak force</td><td>[\d.]+ N</td>", shown)
    assert "torque" not in shown


PLAIN = {
    "deg", "parameter", "known_plants", "file_of_plant", "flexible_link",
    "rigid_link", "non_dominated", "look", "looks", "quartiles",
}  # fmt: skip
"""Functions of a few lines of arithmetic, or of drawing into what is there."""


def test_in_no_public_function_is_ctrl_c_lost():
    functions = {name: one for name, one in _public().items() if inspect.isfunction(one)}
    marked = {name for name, one in functions.items() if is_interruptible(one)}
    assert functions.keys() - marked == PLAIN


@pytest.mark.parametrize(
    "method",
    [
        qa.Plan.save, qa.Plan.load, qa.Plan.save_csv, qa.Front.save_csv, qa.Robot.load,
        qa.ocp.profiles.joint_profile.JointPath.__call__, Compiled.run, Compiled.solve,
        qa.__getattr__, qa.ocp.__getattr__,
    ],
)  # fmt: skip
def test_in_no_method_that_works_is_ctrl_c_lost(method):
    assert is_interruptible(getattr(method, "__func__", method))
