"""The right answers of the exercises, computed with quietarm: one function each.

They are the solutions in other words. Whoever wants to be checked reads them last.
"""

import re
from dataclasses import dataclass, replace
from functools import cache
from importlib import metadata
from math import ceil, log, pi
from pathlib import Path
from typing import ClassVar

import casadi
import numpy as np
from checks import AtRest, Choice, Numbers

import quietarm as qa
from quietarm.metaheuristics import CONSTRICTION, INERTIA_2002, VEPSO, MoveFunction
from quietarm.metaheuristics.score import shares_of_box
from quietarm.ocp import perturb_plant
from quietarm.ocp.energy import CopperLoss
from quietarm.studies.compare import compare_fronts
from quietarm.studies.reproduce.paper import (
    ARM_HALF,
    COEFFICIENTS,
    ROWS,
    SINGLE_LINK_SIXTH,
)

PLATE = qa.SingleLinkManipulator()
MOVE = qa.PointToPoint(PLATE, target=pi / 6, duration=0.8)
"""The first move of the first notebook."""
WEAK = replace(MOVE, torque_limit=0.13)
ARM = qa.ArmOnFlexibleLink()
TURN = qa.PointToPoint(ARM, target=pi / 2, duration=0.8)
BOX = 0.2
"""Equation (12)."""
FOUR = qa.CycloidPolynomial(4)
SIX = qa.CycloidPolynomial(6)


def energies(tasks, profile=SIX, **settings):
    """Return the energies of the plans of several tasks [J]."""
    return np.array([qa.plan_move(task, profile, **settings).energy for task in tasks])


def energies_by_terms(task, numbers, **settings):
    """Return the energies of one task with several numbers of terms [J]."""
    profiles = [qa.CycloidPolynomial(terms) for terms in numbers]
    return np.array([qa.plan_move(task, profile, **settings).energy for profile in profiles])


@cache
def first_plan():
    return qa.plan_move(MOVE)


@cache
def plate_front():
    """The front by limits within the paper's bounds."""
    return qa.epsilon_front(MOVE, bound=BOX, points=10)


# 01 Plan a move


def quiet_duration():
    durations = np.linspace(0.5, 1.6, 111)
    residuals = [
        qa.evaluate_coefficients(replace(MOVE, duration=T), []).residual for T in durations
    ]
    return durations[np.argmax(np.array(residuals) < 1e-3)]


def energy_by_pairs_of_coefficients():
    return energies_by_terms(MOVE, (2, 4, 6, 8))


def residual_on_a_stiffer_plate():
    stiffer = replace(MOVE, plant=replace(PLATE, omega=1.05 * PLATE.omega))
    return 1e3 * qa.evaluate_coefficients(stiffer, first_plan().coefficients).residual


# 02 Three flexible plants


def angle_without_excitation():
    return np.degrees(np.arccos(-ARM.alpha2 / ARM.alpha3))


def duration_for_two_links():
    durations = np.linspace(1.0, 2.0, 101)
    tasks = [qa.PointToPoint(qa.DualLinkManipulator(), pi / 2, T) for T in durations]
    return durations[np.argmin([qa.evaluate_coefficients(task, []).residual for task in tasks])]


def energy_by_acceleration():
    return 1e3 * energies([replace(MOVE, acceleration_limit=limit) for limit in (40.0, 20.0, 10.0)])


# 03 Shaping a move


def bounds_of_turning_back():
    times = np.linspace(0, MOVE.duration, 20_001)

    def turns_back(coefficients):
        profile = qa.CycloidPolynomial(len(coefficients))
        speeds = profile.path(coefficients, *MOVE.move)(times, 1)
        return speeds.min() < -1e-20  # more than rounding, at the ends as well

    def largest(direction):
        low, high = 0.0, 1.0
        while high - low > 1e-4:
            middle = (low + high) / 2
            if turns_back(middle * np.array(direction)):
                high = middle
            else:
                low = middle
        return low

    return largest([1.0]), -largest([0.0, -1.0]), largest([0.0, 1.0])


# 04 Searching without a gradient


def energy_by_luck():
    box = np.random.default_rng(3).uniform(-BOX, BOX, (40_000, 6))
    residual, energy = MoveFunction(MOVE, SIX, bound=BOX)(box)[0].T
    return 1e3 * energy[residual <= 5e-3].min()


def median_share(algorithm, **settings):
    fronts = [
        qa.search(MOVE, algorithm=algorithm, bound=BOX, seed=seed, **settings) for seed in range(3)
    ]
    return np.median([shares_of_box(front)[-1] for front in fronts])


def worst_population():
    budgets = {60: 8, 24: 20, 8: 60}
    return min(
        budgets,
        key=lambda size: median_share("nsga2-paper", population=size, generations=budgets[size]),
    )


def better_rule():
    rules = {"constriction": CONSTRICTION, "inertia": INERTIA_2002}
    return max(rules, key=lambda name: median_share(VEPSO(25, rule=rules[name]), generations=40))


# 05a The whole problem


def energy_of_a_weak_motor():
    return 1e3 * qa.plan_move(WEAK, SIX).energy


def energy_in_a_wide_box():
    return 1e3 * qa.plan_move(MOVE, bound=1.0).energy


def energy_of_least_heat():
    cool = qa.plan_move(replace(MOVE, energy=CopperLoss(1.0)), SIX)
    return 1e3 * qa.evaluate_coefficients(MOVE, cool.coefficients).energy


# 05b KKT


def energies_beside_ten_millimetres():
    return [
        1e3 * qa.plan_move(WEAK, SIX, residual_limit=limit, bound=0.5).energy
        for limit in (9e-3, 11e-3)
    ]


def prices_of_torque():
    plans = [
        qa.plan_move(replace(MOVE, torque_limit=limit), SIX, residual_limit=6e-3, bound=0.5)
        for limit in (0.13, 0.3)
    ]
    return [1e3 * plan.shadow_prices.get("torque", 0.0) for plan in plans]


def starts_needed():
    return [ceil(log(0.01) / log(1 - share)) for share in (0.5, 0.25)]


# 06 Fronts, cross-checked


def epsilon_of_a_thin_front():
    front = plate_front()
    thin = replace(front, points=front.points[::3])
    groups = compare_fronts([front, thin], ["all points", "every third"]).groups
    runs = {run.name: run for group in groups for run in group.runs}
    return runs["every third"].scores["epsilon"]


def gap_of_the_second_move():
    second = qa.PointToPoint(PLATE, target=pi / 2, duration=1.0)
    (gap,) = qa.weighted_front(second, bound=BOX, points=8).gaps
    return 1e3 * np.array(gap)


def distance_after_polishing():
    random = np.random.default_rng(1).uniform(-BOX, BOX, (80, 6))
    chance = qa.Front.from_coefficients(MOVE, random, method="chance", bound=BOX)
    polished = qa.polish_front(chance).front
    front = plate_front()
    best = np.interp(polished.residuals, front.residuals, front.energies)
    return (polished.energies / best).max()


# 07 How low can it go?


def ratios_to_the_bound():
    slow = replace(MOVE, duration=2.0)
    bound = PLATE.c * slow.target**2 / slow.duration
    return energies_by_terms(slow, (6, 14), starts=1) / bound


def energies_by_jerk():
    tasks = [replace(MOVE, jerk_limit=limit) for limit in (4000.0, 1000.0, 300.0)]
    return 1e3 * energies(tasks, qa.CycloidPolynomial(18), starts=1)


def ratio_of_the_arm():
    bound = ARM.c * TURN.target**2 / TURN.duration
    return qa.plan_move(TURN, SIX, starts=1).energy / bound


# 08 When the model is wrong


def percentiles():
    uncertain = replace(MOVE, uncertainty=qa.Uncertainty({"frequency": 0.1}))
    limit = 0.05 * qa.evaluate_coefficients(MOVE, []).residual
    plans = (
        first_plan(),
        qa.plan_move(MOVE, qa.shaped_cycloid(MOVE, "zvd")),
        qa.plan_move(uncertain, residual_limit=limit, starts=1),
    )
    errors = {"frequency": 0.1, "zeta": 0.5}
    spread = [qa.evaluate_robustness(plan.candidate, errors, samples=1000) for plan in plans]
    return [1e3 * figures.percentile("residual", 95) for figures in spread]


def residual_with_a_payload():
    loaded = replace(MOVE, plant=perturb_plant(PLATE, {"frequency": -0.08}))
    return 1e3 * qa.evaluate_coefficients(loaded, first_plan().coefficients).residual


def share_that_a_shaper_leaves():
    shaped = qa.plan_move(TURN, qa.shaped_cycloid(TURN, "zv"))
    return 100 * shaped.residual / qa.evaluate_coefficients(TURN, []).residual


# 09 Your own plant


@dataclass(frozen=True)
class BeltTable(qa.Plant):
    """The table of the notebook."""

    name: ClassVar[str] = "belt-table-of-the-checks"
    modes: ClassVar[int] = 1

    stiffness: float = qa.parameter(8.0, "N m/rad", "belt's data sheet, at the table")
    table: float = qa.parameter(0.12, "kg m^2", "drawing")
    motor: float = qa.parameter(0.02, "kg m^2", "motor's data sheet, at the table")
    friction: float = qa.parameter(0.05, "N m s", "measured at constant speed")
    zeta: float = qa.parameter(0.02, "-", "measured, swinging freely")
    radius: float = qa.parameter(0.30, "m", "drawing")

    def modal_accelerations(self, joint, W, dW):
        omega = casadi.sqrt(self.stiffness / self.table)
        push = self.radius * joint.acceleration
        return [-2 * self.zeta * omega * dW[0] - omega**2 * W[0] - push]

    def torque(self, joint, W, dW, ddW):
        moved = self.table * (joint.acceleration + ddW[0] / self.radius)
        return self.motor * joint.acceleration + self.friction * joint.speed + moved

    def tip_displacements(self, W):
        return [W[0]]


@dataclass(frozen=True)
class MastOnTable(BeltTable):
    """The camera on its mast."""

    name: ClassVar[str] = "mast-of-the-checks"
    modes: ClassVar[int] = 2

    mast: float = qa.parameter(20.0, "rad/s", "the exercise")

    def modal_accelerations(self, joint, W, dW):
        (rim,) = super().modal_accelerations(joint, W, dW)
        excitation = self.radius * joint.acceleration + rim
        return [rim, -(self.mast**2) * W[1] - excitation]

    def tip_displacements(self, W):
        return [W[0] + W[1]]


HALF_TURN = qa.PointToPoint(BeltTable(), target=pi, duration=1.0)


def torque_of_a_rigid_table():
    times = np.linspace(0, HALF_TURN.duration, 2001)
    joint = qa.evaluate_coefficients(HALF_TURN, []).sampled(times).joint
    table = HALF_TURN.plant
    torque = (table.motor + table.table) * joint[:, 2] + table.friction * joint[:, 1]
    return np.abs(torque).max()


def energy_with_a_mast():
    return qa.plan_move(replace(HALF_TURN, plant=MastOnTable()), starts=2).energy


def when_a_parameter_is_refused():
    try:
        table = BeltTable(stiffness=-8.0)
    except ValueError:
        return "creation"
    try:
        table.validate()
    except ValueError:
        return "validate"
    return "plan"


# 10 The paper, claim by claim


def residuals_of_rounding():
    values = np.array(COEFFICIENTS[SINGLE_LINK_SIXTH, 6])
    unit = 10.0 ** (np.floor(np.log10(np.abs(values))) - 3)
    errors = np.random.default_rng(0).uniform(-0.5, 0.5, (30, 6)) * unit
    task = SINGLE_LINK_SIXTH.task
    residuals = [qa.evaluate_coefficients(task, values + error).residual for error in errors]
    return 1e3 * min(residuals), 1e3 * max(residuals)


def residuals_from_elsewhere():
    cases = SINGLE_LINK_SIXTH, ARM_HALF
    moved = [replace(case.task, start=1.0, target=1.0 + case.task.target) for case in cases]
    return [
        1e3 * qa.evaluate_coefficients(task, COEFFICIENTS[case, 2]).residual
        for case, task in zip(cases, moved, strict=True)
    ]


def misprinted_coefficient():
    (printed,) = [
        row.energy for row in ROWS if (row.table, row.condition, row.terms) == (5, ARM_HALF, 6)
    ]
    misses = {}
    for place, value in enumerate(COEFFICIENTS[ARM_HALF, 6]):
        for factor in (0.1, 10.0, -1.0):
            guess = list(COEFFICIENTS[ARM_HALF, 6])
            guess[place] = factor * value
            energy = qa.evaluate_coefficients(ARM_HALF.task, guess).energy
            misses[abs(energy - printed)] = place + 1
    return misses[min(misses)]


# 11 From a recording to a controller

MACHINE = qa.FlexibleBeam(omega=20.1, zeta=0.01, length=0.6, tip_mass=0.2)


def push(seed, seconds=3.0):
    """The recording of the notebook."""
    time = np.arange(0, seconds, 0.005)
    random = np.random.default_rng(seed)
    decay = MACHINE.zeta * MACHINE.omega
    rate = MACHINE.omega * np.sqrt(1 - MACHINE.zeta**2)
    swing = 0.02 * np.exp(-decay * time) * np.cos(rate * time + random.uniform(0, 2 * pi))
    tip = np.round(swing + 1e-3 * random.standard_normal(len(time)), 3)
    return qa.Recording(time, tip=tip, name=f"push {seed}")


def widths_of_frequency():
    sets = [push(1, seconds=9.0)], [push(seed) for seed in (1, 2, 3)]
    identified = [qa.identify(pushes, qa.FlexibleBeam(), ["omega"]).estimates[0] for pushes in sets]
    return [1e2 * (omega.high - omega.low) / 2 / omega.value for omega in identified]


def widths_of_two_machines():
    second = push(2)
    faster = qa.Recording(second.time / 1.02, tip=second.tip, name="the other")
    omega = qa.identify([push(1), faster], qa.FlexibleBeam(), ["omega"]).estimates[0]
    return [100 * (end / omega.value - 1) for end in (omega.high, omega.next_high)]


def errors_of_damping():
    errors = []
    for seconds in (1.0, 2.0, 3.0):
        estimates = qa.identify([push(4, seconds)], qa.FlexibleBeam()).estimates
        errors += [100 * estimate.error for estimate in estimates if estimate.parameter == "zeta"]
    return errors


# 12 How stiff should the arm be?


def catalogue_task(frequency, length=0.6, torque_limit=1.2):
    beam = qa.FlexibleBeam(omega=2 * pi * frequency, length=length, tip_mass=0.2, zeta=0.01)
    return qa.PointToPoint(beam, pi / 3, 0.9, torque_limit=torque_limit, residual_window=1.0)


def energies_until_enough():
    return 1e3 * energies_by_terms(catalogue_task(2.0), (6, 9, 12, 15, 18), starts=1)


def powers_of_the_length():
    lengths = np.array([0.4, 0.6, 0.8])
    tasks = [catalogue_task(4.0, length, torque_limit=None) for length in lengths]
    by_terms = [energies(tasks, qa.CycloidPolynomial(terms), starts=1) for terms in (6, 18)]
    return [np.polyfit(np.log(lengths), np.log(found), 1)[0] for found in by_terms]


def shares_for_five_millimetres():
    tasks = [catalogue_task(frequency) for frequency in (2.0, 5.0)]
    profile = qa.CycloidPolynomial(18)
    at_rest = energies(tasks, profile, starts=1)
    relaxed = energies(tasks, profile, residual_limit=5e-3, starts=1)
    return 100 * (1 - relaxed / at_rest)


# 13 A six-axis robot carries a bar

POSTURE = np.array([0.0, -1.4, 1.7, -1.87, -1.57, 0.0])
ARRIVAL = np.array([1.4, -1.0, 1.2, -1.3, -1.2, 0.6])


@cache
def robot(tip_mass=0.5):
    """The UR5 of `example-robot-data` with its bar."""
    files = metadata.files("example-robot-data")
    urdf = next(file.locate() for file in files if file.name == "ur5_robot.urdf")
    bar = qa.Beam(
        at="tool0",
        length=0.8,
        width=0.008,
        height=0.012,
        youngs_modulus=70e9,
        density=2700.0,
        tip_mass=tip_mass,
        damping=0.005,
    )
    return qa.Robot(urdf=urdf, beam=bar)


def robot_task(duration=1.0, tip_mass=0.5):
    path = qa.GeometricPath.line(POSTURE, ARRIVAL)
    return qa.PointToPoint(robot(tip_mass).along(path), target=1.0, duration=duration)


def residuals_with_a_heavy_load():
    plan = qa.plan_move(robot_task())
    heavy = robot_task(tip_mass=0.6)
    return [
        1e3 * qa.evaluate_coefficients(heavy, coefficients).residual
        for coefficients in (plan.coefficients, [])
    ]


def energies_by_duration():
    return [qa.plan_move(robot_task(duration), starts=1).energy for duration in (0.8, 1.0, 1.4)]


def energy_straight_in_space():
    line = qa.GeometricPath.cartesian_line(robot(), POSTURE, by=[0.2, 0.3, -0.1])
    return qa.plan_move(qa.PointToPoint(robot().along(line), target=1.0, duration=1.0)).energy


AXIS_OF_A_USER = qa.LinearAxis(omega1=2 * pi * 4.9, zeta1=0.01, mass=60.0, load=12.0, friction=30.0)
"""What the user of notebook 14 believes of the machine."""


def executed(plan, load=12.0, seconds=1.5):
    """Time [s], motor, tool [m] and force [N] of the machine of notebook 14 for a plan."""
    step = 2.5e-4
    time = np.arange(0, plan.task.duration + seconds, step)
    stiffness, damping = 12.0 * (2 * pi * 5.3) ** 2, 0.02 * 12.0 * 2 * pi * 5.3
    place = speed = swing = rate = force = 0.0
    rows = []
    for place_set, speed_set, acceleration_set in plan.sampled(time).joint.tolist():
        error = speed_set - speed + 50.0 * (place_set - place)
        force += step / 1e-3 * (72.0 * acceleration_set + 15e3 * error - force)
        friction = 20.0 * np.tanh(speed / 1e-3) + 30.0 * speed
        pull = stiffness * swing + damping * rate
        acceleration = (force - friction + pull) / 60.0
        speed += step * acceleration
        place += step * speed
        rate += step * (-pull / load - acceleration)
        swing += step * rate
        rows.append((place, place + 1.15 * swing, force))
    return time, *np.array(rows).T


def recorded(run, seed):
    """The recording of a run by a laser, an encoder and the drive's force."""
    time, motor, tool, force = (values[::8] for values in run)
    random = np.random.default_rng(seed)
    tip = tool + random.normal(0, 2e-5, len(time))
    angle = np.round(motor / 2e-6) * 2e-6
    torque = force + random.normal(0, 2.0, len(time))
    return qa.Recording(time, tip=tip, angle=angle, torque=torque, name=f"run {seed}")


def left_by(plan, load=12.0):
    """What the machine leaves of a plan [mm]."""
    time, _, tool, _ = executed(plan, load)
    return 1e3 * float(np.ptp(tool[time > plan.task.duration + 0.05])) / 2


@cache
def learned_moves(count):
    """The plan and the answer of each move, the first with the user's model."""
    task = qa.PointToPoint(AXIS_OF_A_USER, target=0.5, duration=0.7)
    plan = qa.plan_move(task, SIX)
    moves = []
    for seed in range(1, count + 1):
        learned = qa.learn(plan, [recorded(executed(plan), seed)])
        moves.append((plan, learned))
        plan = learned.plan
    return moves


def left_without_a_laser():
    ((first, _),) = learned_moves(1)
    run = recorded(executed(first), 1)
    blind = qa.Recording(run.time, angle=run.angle, torque=run.torque, name="blind")
    return left_by(qa.learn(first, [blind]).plan)


def left_with_other_loads():
    *_, (_, learned) = learned_moves(2)
    return [left_by(learned.plan, load) for load in (11.0, 13.0)]


def left_by_the_frequency_alone():
    ((_, learned),) = learned_moves(1)
    task = qa.PointToPoint(learned.machine.plant, target=0.5, duration=0.7)
    return left_by(qa.plan_move(task, SIX))


# 15 Any simulator; MuJoCo is loaded where it is needed


def arm_in_mujoco(**servo):
    """The arm of docs/simulators.md in MuJoCo, with the servo's gains if they are given."""
    import mujoco

    page = Path(__file__).parents[1] / "docs" / "simulators.md"
    text = page.read_text(encoding="utf-8").partition("```xml\n")[2].partition("```")[0]
    for gain, value in servo.items():
        text = re.sub(f'{gain}="[^"]*"', f'{gain}="{value}"', text)
    return mujoco.MjModel.from_xml_string(text)


def swung(model, coefficients):
    """Residual [m] and energy [J] of a motion in MuJoCo, and what is missing of 2 mm [m]."""
    import mujoco

    data = mujoco.MjData(model)
    residual, energy, nearest = 0.0, 0.0, np.inf
    for time, *sent, _ in zip(*qa.motion_of(MOVE, FOUR, coefficients, after=0.4), strict=True):
        data.ctrl = sent
        mujoco.mj_step(model, data)
        x, y, _, clearance, speed, torque = data.sensordata
        nearest = min(nearest, clearance)
        if time < MOVE.duration:
            energy += 1e-3 * abs(speed * torque)
        else:
            residual = max(residual, abs(complex(x, y) - 0.4 * np.exp(1j * MOVE.target)))
    return (residual, energy), (0.002 - nearest,)


def plan_for_the_arm():
    """The plan by the mass matrix of the arm, without friction, backlash and post."""
    import mujoco

    data = mujoco.MjData(arm_in_mujoco())
    mujoco.mj_forward(data.model, data)
    masses = np.zeros((3, 3))
    mujoco.mj_fullM(data.model, data, masses)
    outer, coupling = masses[2, 2], masses[1, 2]
    plant = qa.SingleLinkManipulator(
        alpha1=masses[0, 0] + masses[1, 1],
        alpha2=coupling / 0.2,
        c=0.0,
        beta1=0.2 * coupling / outer,
        beta2=coupling / outer - 1,
        zeta=0.0005 / (2 * np.sqrt(0.3 * outer)),
        omega=np.sqrt(0.3 / outer),
        phi=1.0,
    )
    return qa.plan_move(replace(MOVE, plant=plant), FOUR)


def left_with_a_stiffer_servo():
    stiff = arm_in_mujoco(kp=160, kv=1.6)
    stiff.joint("motor").frictionloss = 0
    stiff.tendon_range[0] = -1e-5, 1e-5
    stiff.geom("post").pos = 1, 0, 0
    (residual, _), _ = swung(stiff, plan_for_the_arm().coefficients)
    return 1e3 * residual


@cache
def drawn_motions():
    """The front of 200 random candidates of the arm."""
    model = arm_in_mujoco()
    lower, upper = FOUR.box(0.3)
    return qa.search(
        lambda candidate: swung(model, candidate),
        lower=lower,
        upper=upper,
        constraints=["clearance"],
        evaluations=200,
        algorithm="random",
        seed=1,
    )


def clear_and_least_by_chance():
    drawn = drawn_motions()
    return [200 - drawn.infeasible, 1e3 * drawn.smallest_residual().residual]


def left_with_a_worn_gear():
    worn = arm_in_mujoco()
    worn.tendon_range[0] = -0.006, 0.006
    (residual, _), _ = swung(worn, drawn_motions().smallest_residual().coefficients)
    return 1e3 * residual


EXERCISES = {
    "01": (
        Numbers(
            "the shortest duration with a residual below 1 mm", "s", quiet_duration, tolerance=0.006
        ),
        Numbers(
            "the energies with 2, 4, 6 and 8 terms", "J", energy_by_pairs_of_coefficients, count=4
        ),
        Numbers(
            "the residual of the plan on the stiffer plate",
            "mm",
            residual_on_a_stiffer_plate,
            tolerance=0.05,
        ),
    ),
    "02": (
        Numbers("the angle without excitation", "degrees", angle_without_excitation),
        Numbers("the duration with the smallest residual", "s", duration_for_two_links),
        Numbers("the energies within 40, 20 and 10 rad/s^2", "mJ", energy_by_acceleration, count=3),
    ),
    "03": (
        AtRest("a1 and a2 of the plate", MOVE, count=2, limit=1e-4),
        Numbers(
            "the largest a1, the lowest a2 and the largest a2 without turning back",
            "-",
            bounds_of_turning_back,
            count=3,
        ),
        AtRest("a1 and a2 of the arm", TURN, count=2, limit=5e-4),
    ),
    "04": (
        Numbers(
            "the cheapest of 40 000 random moves within 5 mm", "mJ", energy_by_luck, tolerance=0.1
        ),
        Choice("the population that does worst", (60, 24, 8), worst_population),
        Choice("the rule with the better front", ("constriction", "inertia"), better_rule),
    ),
    "05a": (
        Numbers("the energy at rest within 0.13 N m", "mJ", energy_of_a_weak_motor),
        Numbers("the energy for the smallest delta", "mJ", energy_in_a_wide_box, tolerance=0.01),
        Numbers("the energy of the motion of least heat", "mJ", energy_of_least_heat),
    ),
    "05b": (
        Numbers(
            "the energies within 9 and 11 mm",
            "mJ",
            energies_beside_ten_millimetres,
            count=2,
            tolerance=0.01,
        ),
        Numbers(
            "the shadow prices of the torque at 0.13 and 0.3 N m",
            "mJ/(N m)",
            prices_of_torque,
            count=2,
            tolerance=0.1,
        ),
        Numbers(
            "the numbers of starts for q = 0.5 and 0.25",
            "-",
            starts_needed,
            count=2,
            tolerance=1e-9,
        ),
    ),
    "06": (
        Numbers("epsilon of every third point", "-", epsilon_of_a_thin_front, tolerance=0.1),
        Numbers("the two ends of the gap", "mm", gap_of_the_second_move, count=2, tolerance=0.05),
        Numbers(
            "the energy of the polished points over that of the front by limits, at most",
            "-",
            distance_after_polishing,
            tolerance=0.01,
        ),
    ),
    "07": (
        Numbers("the ratios at 2.0 s with 6 and 14 terms", "-", ratios_to_the_bound, count=2),
        Numbers(
            "the energies within 4000, 1000 and 300 rad/s^3 with 18 terms",
            "mJ",
            energies_by_jerk,
            count=3,
        ),
        Numbers("the energy with six terms over the bound", "-", ratio_of_the_arm),
    ),
    "08": (
        Numbers(
            "the 95th percentiles of the plan, ZVD and the robust plan",
            "mm",
            percentiles,
            count=3,
            tolerance=0.1,
        ),
        Numbers(
            "the residual of the old plan with the payload",
            "mm",
            residual_with_a_payload,
            tolerance=0.05,
        ),
        Numbers(
            "the share of the cycloid's residual that ZV leaves", "%", share_that_a_shaper_leaves
        ),
    ),
    "09": (
        Numbers(
            "the peak torque for a rigid table", "N m", torque_of_a_rigid_table, tolerance=0.01
        ),
        Numbers("the energy of the plan with the mast", "J", energy_with_a_mast),
        Choice(
            "the first that refuses it",
            ("creation", "validate", "plan"),
            when_a_parameter_is_refused,
        ),
    ),
    "10": (
        Numbers(
            "the smallest and the largest residual with other last digits",
            "mm",
            residuals_of_rounding,
            count=2,
            tolerance=0.03,
        ),
        Numbers(
            "the residuals of plate and arm from 1 rad", "mm", residuals_from_elsewhere, count=2
        ),
        Choice(
            "n of the a_n whose correction fits the energy best",
            (1, 2, 3, 4, 5, 6),
            misprinted_coefficient,
        ),
    ),
    "11": (
        Numbers(
            "half the frequency's interval, of one long and of three recordings",
            "%",
            widths_of_frequency,
            count=2,
            tolerance=0.2,
        ),
        Numbers(
            "half the widths for the mean and for the next recording",
            "%",
            widths_of_two_machines,
            count=2,
            tolerance=0.1,
        ),
        Numbers(
            "half the widths of the damping's interval after 1, 2 and 3 s",
            "%",
            errors_of_damping,
            count=3,
            tolerance=0.1,
        ),
    ),
    "12": (
        Numbers(
            "the energies with 6, 9, 12, 15 and 18 terms", "mJ", energies_until_enough, count=5
        ),
        Numbers("the powers of the length with 6 and 18 terms", "-", powers_of_the_length, count=2),
        Numbers(
            "the shares of energy that 5 mm save at 2 and at 5 Hz",
            "%",
            shares_for_five_millimetres,
            count=2,
            tolerance=0.1,
        ),
    ),
    "13": (
        Numbers(
            "the residuals of plan and cycloid with 600 g",
            "mm",
            residuals_with_a_heavy_load,
            count=2,
        ),
        Numbers("the energies in 0.8, 1.0 and 1.4 s", "J", energies_by_duration, count=3),
        Numbers("the energy of the straight move", "J", energy_straight_in_space),
    ),
    "14": (
        Numbers(
            "what the second move leaves without a laser", "mm", left_without_a_laser, tolerance=0.2
        ),
        Numbers(
            "what the third plan leaves with 11 kg and with 13 kg",
            "mm",
            left_with_other_loads,
            count=2,
            tolerance=0.1,
        ),
        Numbers(
            "what the plan with the learned machine leaves",
            "mm",
            left_by_the_frequency_alone,
            tolerance=0.1,
        ),
    ),
    "15": (
        Numbers(
            "what the plan leaves with the stiffer servo",
            "mm",
            left_with_a_stiffer_servo,
            tolerance=0.05,
        ),
        Numbers(
            "how many candidates keep clear, and their smallest residual [mm]",
            "-",
            clear_and_least_by_chance,
            count=2,
            tolerance=0.05,
        ),
        Numbers(
            "what the motion leaves with the worn gear", "mm", left_with_a_worn_gear, tolerance=0.05
        ),
    ),
}
"""What the three exercises of every notebook ask for."""
