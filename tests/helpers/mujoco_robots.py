"""Robots in MuJoCo: every hinge of what bends, nonlinear, with springs by its own equations.

It knows nothing of quietarm's models: the URDF is written here, the joints are prescribed, and the
springs' angles follow by LSODA. It tells what a motion leaves, and what it takes.
"""

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field

import numpy as np
import pytest
from scipy.integrate import solve_ivp

mujoco = pytest.importorskip("mujoco")

GRAVITY = (0.0, 0.0, -9.80665)
# MuJoCo has no moving body without a mass; 24 hinges have a hundred-thousandth of the bar's.
HINGE = {"mass": 1e-7, "moments": (1e-9, 1e-9, 1e-9)}
# Of a joint that moves a part of the robot, and not a hinge alone [kg m^2].
LEAST_INERTIA = 1e-6


@dataclass
class FlexibleRobot:
    """A URDF that grows by joints with springs."""

    file: str
    stiffness: dict = field(default_factory=dict)
    damping: dict = field(default_factory=dict)
    tip: tuple = ()

    def __post_init__(self):
        self.root = ElementTree.parse(self.file).getroot()
        for element in list(self.root.iter()):
            for child in list(element):
                if child.tag in (
                    "visual",
                    "collision",
                    "transmission",
                    "gazebo",
                    "material",
                    "mimic",
                ):
                    element.remove(child)

    def add_link(self, name, mass, centre, moments):
        link = ElementTree.SubElement(self.root, "link", name=name)
        inertial = ElementTree.SubElement(link, "inertial")
        ElementTree.SubElement(inertial, "origin", xyz=_text(centre), rpy="0 0 0")
        ElementTree.SubElement(inertial, "mass", value=repr(float(mass)))
        entries = dict(zip(("ixx", "iyy", "izz"), map(repr, map(float, moments))))
        ElementTree.SubElement(inertial, "inertia", **entries, ixy="0", ixz="0", iyz="0")

    def add_joint(self, name, parent, child, place, axis=None, stiffness=None, damping=0.0):
        kind = "fixed" if axis is None else "revolute"
        joint = ElementTree.SubElement(self.root, "joint", name=name, type=kind)
        ElementTree.SubElement(joint, "parent", link=parent)
        ElementTree.SubElement(joint, "child", link=child)
        ElementTree.SubElement(joint, "origin", xyz=_text(place), rpy="0 0 0")
        if axis is not None:
            ElementTree.SubElement(joint, "axis", xyz=axis)
            ElementTree.SubElement(joint, "limit", lower="-3", upper="3", effort="1", velocity="1")
            self.stiffness[name] = stiffness
            self.damping[name] = damping

    def add_fixed(self, name, parent, place, turned):
        """A link without mass that stands in another, turned by roll, pitch and yaw."""
        ElementTree.SubElement(self.root, "link", name=name)
        joint = ElementTree.SubElement(self.root, "joint", name=f"to_{name}", type="fixed")
        ElementTree.SubElement(joint, "parent", link=parent)
        ElementTree.SubElement(joint, "child", link=name)
        ElementTree.SubElement(joint, "origin", xyz=_text(place), rpy=_text(turned))

    def add_bar(
        self, at, length, width, height, youngs_modulus, density, tip_mass, damping, pieces=12
    ):
        """Rigid pieces with hinges in the middle of each of equal parts, clamped to a link.

        The rule of the middles misses a share of 1 / (4 pieces^2) of what a force at the tip bends:
        the springs are softer by so much.
        """
        part = length / pieces
        youngs_modulus = youngs_modulus * (1 - 1 / (4 * pieces**2))
        line_mass = density * width * height

        def piece(name, of_length, tip=0.0):
            mass = line_mass * of_length
            squares = (of_length**2 + width**2, of_length**2 + height**2, width**2 + height**2)
            moments = np.array(squares) * mass / 12
            centre = (mass * of_length / 2 + tip * of_length) / (mass + tip)
            apart = mass * (of_length / 2 - centre) ** 2 + tip * (of_length - centre) ** 2
            self.add_link(name, mass + tip, (0, 0, centre), moments + np.array([apart, apart, 0.0]))

        across = {"1 0 0": height * width**3 / 12, "0 1 0": width * height**3 / 12}
        stiffness = {axis: youngs_modulus * second / part for axis, second in across.items()}
        piece("bar_0", part / 2)
        self.add_joint("clamp", at, "bar_0", (0, 0, 0))
        hinges = []
        for number in range(1, pieces + 1):
            last = number == pieces
            begin = part / 2 if number == 1 else part
            self.add_link(f"hinge_{number}", HINGE["mass"], (0, 0, 0), HINGE["moments"])
            piece(f"bar_{number}", part / 2 if last else part, tip_mass if last else 0.0)
            names = (f"bend_y_{number}", f"bend_x_{number}")
            self.add_joint(
                names[0],
                f"bar_{number - 1}",
                f"hinge_{number}",
                (0, 0, begin),
                "1 0 0",
                stiffness["1 0 0"],
            )
            self.add_joint(
                names[1], f"hinge_{number}", f"bar_{number}", (0, 0, 0), "0 1 0", stiffness["0 1 0"]
            )
            hinges += names
        self.tip = (f"bar_{pieces}", part / 2)
        return hinges

    def add_gear(self, joint, stiffness, damping):
        """A sprung joint between a driven joint and its link."""
        element = next(one for one in self.root.findall("joint") if one.get("name") == joint)
        child = element.find("child")
        link = child.get("link")
        self.add_link(f"motor_{joint}", HINGE["mass"], (0, 0, 0), HINGE["moments"])
        child.set("link", f"motor_{joint}")
        axis = element.find("axis").get("xyz")
        self.add_joint(f"gear_{joint}", f"motor_{joint}", link, (0, 0, 0), axis, stiffness, damping)

    def add_base(self, stiffness, damping, height):
        """Two sprung joints below the root link."""
        root = self._rename_root("foot")
        self.add_link("ground", 1.0, (0, 0, 0), (1.0, 1.0, 1.0))
        self.add_link("rocker", HINGE["mass"], (0, 0, 0), HINGE["moments"])
        self.add_link("pedestal", HINGE["mass"], (0, 0, 0), HINGE["moments"])
        self.add_joint("rock_x", "ground", "rocker", (0, 0, -height), "1 0 0", stiffness, damping)
        self.add_joint("rock_y", "rocker", "pedestal", (0, 0, 0), "0 1 0", stiffness, damping)
        self.add_joint("on_top", "pedestal", root, (0, 0, height))

    def _rename_root(self, name):
        """The root link by another name: MuJoCo takes one that is called `world` as the ground."""
        children = {joint.find("child").get("link") for joint in self.root.findall("joint")}
        roots = [link for link in self.root.findall("link") if link.get("name") not in children]
        (root,) = roots
        before = root.get("name")
        root.set("name", name)
        for joint in self.root.findall("joint"):
            parent = joint.find("parent")
            if parent.get("link") == before:
                parent.set("link", name)
        return name


class Truth:
    """A flexible robot whose driven joints follow a motion."""

    tolerance = 1e-9

    def __init__(self, robot, driven, damping_ratio=0.0, hinges=(), softened=1.0, held=None):
        text = ElementTree.tostring(robot.root, encoding="unicode")
        self.model = mujoco.MjModel.from_xml_string(text)
        self.data = mujoco.MjData(self.model)
        self.model.opt.gravity[:] = GRAVITY
        names = list(robot.stiffness)
        self.driven = np.array([self._place(name) for name in driven])
        self.sprung = np.array([self._place(name) for name in names])
        self.fixed = {self._place(name): position for name, position in (held or {}).items()}
        assert self.model.nv == len(driven) + len(names) + len(self.fixed)
        self.stiffness = np.array([robot.stiffness[name] for name in names])
        self.damping = np.array([robot.damping[name] for name in names])
        of_bar = np.isin(names, list(hinges))
        if damping_ratio:
            self.damping[of_bar] = (
                self._damping_time(damping_ratio, of_bar) * self.stiffness[of_bar]
            )
        self.stiffness = softened * self.stiffness
        self.body = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_BODY, robot.tip[0])
        self.along = np.array([0.0, 0.0, robot.tip[1]])
        inertias = np.diag(self._dynamics(np.zeros(self.model.nv), np.zeros(self.model.nv))[0])
        assert inertias.min() > LEAST_INERTIA, "a joint carries nothing"

    def residual_and_energy(self, motion, duration, window=1.0):
        """Largest displacement of the tip after arrival [m], energy [J], torques' peaks [N m]."""
        count = len(self.sprung)
        times = np.linspace(0.0, duration, 2001)
        begin = np.concatenate([self.sag(motion(0.0)[0]), np.zeros(count)])
        states = self.followed(motion, times, begin)
        end = motion(duration)[0]
        still = (end, np.zeros_like(end), np.zeros_like(end))
        later = self.followed(lambda _: still, np.linspace(0.0, window, 1001), states[:, -1])
        rest = self.tip_at(end, self.sag(end))
        away = [np.linalg.norm(self.tip_at(end, state[:count]) - rest) for state in later.T]
        powers, torques = [], []
        for time, state in zip(times, states.T):
            q, v, a = motion(time)
            _, torque = self.accelerations(q, v, a, state[:count], state[count:])
            powers.append(np.abs(torque * v))
            torques.append(np.abs(torque))
        energy = np.trapezoid(np.array(powers), times, axis=0).sum()
        return max(away), energy, np.array(torques).max(axis=0)

    def ring_down(self, q, force, times):
        """Let go of a tip that a force [N] bends, with the joints held at q.

        Returns torques of the driven joints, and what an accelerometer at the tip feels along its
        own axes, a row a time.
        """
        count = len(self.sprung)
        sag = self.sag(q)
        levers = np.array([
            (self.tip_at(q, sag + step) - self.tip_at(q, sag - step)) / 2e-6
            for step in 1e-6 * np.eye(count)
        ])  # fmt: skip
        bent = sag + levers @ force / self.stiffness
        still = (q, np.zeros_like(q), np.zeros_like(q))
        states = self.followed(lambda _: still, times, np.concatenate([bent, np.zeros(count)]))
        torques, felt = [], []
        for state in states.T:
            p, dp = state[:count], state[count:]
            springs, torque = self.accelerations(*still, p, dp)
            torques.append(torque)
            felt.append(self.felt(*still, p, dp, springs))
        return np.array(torques), np.array(felt)

    def held_modes(self, q):
        """Return frequencies [Hz] and damping ratios with the joints held, by small deviations."""
        sag = self.sag(q)
        slopes = np.array([
            (self._excess(q, sag + step) - self._excess(q, sag - step)) / 2e-6
            for step in 1e-6 * np.eye(len(sag))
        ])  # fmt: skip
        still = np.zeros(self.model.nv)
        masses, _ = self._dynamics(self._positions(q, sag), still)
        inverse = np.linalg.inv(masses[np.ix_(self.sprung, self.sprung)])
        nothing, one = np.zeros_like(slopes), np.eye(len(sag))
        below = np.hstack([-inverse @ (slopes + slopes.T) / 2, -inverse @ np.diag(self.damping)])
        values = np.linalg.eigvals(np.vstack([np.hstack([nothing, one]), below]))
        above = sorted(values[values.imag > 0], key=abs)
        return np.abs(above) / (2 * np.pi), -np.real(above) / np.abs(above)

    def felt(self, q, v, a, p, dp, ddp):
        """Return what an accelerometer at the tip feels, by differences in time [m/s^2]."""
        step = 1e-4

        def tip(at):
            return self.tip_at(q + v * at + a * at**2 / 2, p + dp * at + ddp * at**2 / 2)

        ahead, behind, here = tip(step), tip(-step), tip(0.0)
        rotation = self.data.xmat[self.body].reshape(3, 3)
        return rotation.T @ ((ahead - 2 * here + behind) / step**2 - np.array(GRAVITY))

    def sag(self, q):
        """The springs' angles at rest, by Newton with differences."""
        p = np.zeros(len(self.sprung))
        for _ in range(60):
            slopes = np.array([
                (self._excess(q, p + step) - self._excess(q, p - step)) / 2e-6
                for step in 1e-6 * np.eye(len(p))
            ]).T  # fmt: skip
            change = np.linalg.solve(slopes, self._excess(q, p))
            p = p - change
            if np.abs(change).max() < 1e-13:
                return p
        raise AssertionError("no equilibrium")

    def tip_at(self, q, p):
        """The tip seen from the ground [m]."""
        self.data.qpos[:] = self._positions(q, p)
        mujoco.mj_kinematics(self.model, self.data)
        rotation = self.data.xmat[self.body].reshape(3, 3)
        return self.data.xpos[self.body] + rotation @ self.along

    def followed(self, motion, times, begin):
        """States of the springs at some times, their angles and then their rates."""
        count = len(self.sprung)

        def rates(time, state):
            accelerations, _ = self.accelerations(*motion(time), state[:count], state[count:])
            return np.concatenate([state[count:], accelerations])

        def slopes(time, state):
            """Of the rates by springs and dampers, which are what is stiff; Newton asks no more."""
            q, _, _ = motion(time)
            masses, _ = self._dynamics(self._positions(q, state[:count]), np.zeros(self.model.nv))
            forces = np.hstack([np.diag(self.stiffness), np.diag(self.damping)])
            changes = np.linalg.solve(masses[np.ix_(self.sprung, self.sprung)], -forces)
            return np.vstack([np.hstack([np.zeros((count, count)), np.eye(count)]), changes])

        ends = (times[0], times[-1])
        tolerances = {"rtol": self.tolerance, "atol": 1e-2 * self.tolerance}
        solved = solve_ivp(rates, ends, begin, "LSODA", times, jac=slopes, **tolerances)
        assert solved.success
        return solved.y

    def accelerations(self, q, v, a, p, dp):
        """Return accelerations of the springs, and torques of the driven joints."""
        masses, bias = self._dynamics(self._positions(q, p), self._rates(v, dp))
        of_springs = masses[np.ix_(self.sprung, self.sprung)]
        between = masses[np.ix_(self.sprung, self.driven)]
        force = -bias[self.sprung] - between @ a - self.stiffness * p - self.damping * dp
        found = np.linalg.solve(of_springs, force)
        own = masses[np.ix_(self.driven, self.driven)]
        return found, own @ a + between.T @ found + bias[self.driven]

    def _excess(self, q, p):
        still = np.zeros(self.model.nv)
        _, bias = self._dynamics(self._positions(q, p), still)
        return bias[self.sprung] + self.stiffness * p

    def _dynamics(self, positions, rates):
        self.data.qpos[:] = positions
        self.data.qvel[:] = rates
        mujoco.mj_fwdPosition(self.model, self.data)
        mujoco.mj_fwdVelocity(self.model, self.data)
        masses = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, masses)
        return masses, self.data.qfrc_bias.copy()

    def _damping_time(self, ratio, of_bar):
        """Damping over stiffness by the ratio of the clamped bar's first mode."""
        masses, _ = self._dynamics(np.zeros(self.model.nv), np.zeros(self.model.nv))
        bar = self.sprung[of_bar]
        root = np.linalg.cholesky(masses[np.ix_(bar, bar)])
        inverse = np.linalg.inv(root)
        squares = np.linalg.eigvalsh(inverse @ np.diag(self.stiffness[of_bar]) @ inverse.T)
        return 2 * ratio / np.sqrt(squares[0])

    def _positions(self, q, p):
        positions = np.zeros(self.model.nv)
        positions[self.driven] = q
        positions[self.sprung] = p
        for place, position in self.fixed.items():
            positions[place] = position
        return positions

    def _rates(self, v, dp):
        rates = np.zeros(self.model.nv)
        rates[self.driven] = v
        rates[self.sprung] = dp
        return rates

    def _place(self, joint):
        number = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_JOINT, joint)
        assert number >= 0, joint
        return self.model.jnt_dofadr[number]


def motion_of(plan):
    """(time) -> positions, speeds and accelerations of the joints of a plan, by its path itself."""
    import casadi as ca

    task = plan.task
    time = ca.SX.sym("t")
    s = plan.profile.motion(list(plan.coefficients), time / task.duration, *task.move)[0]
    ds = ca.jacobian(s, time)
    along = ca.Function("along", [time], [ca.vertcat(s, ds, ca.jacobian(ds, time))])
    return motion_along(task.plant.path, lambda at: along(at).full().ravel())


def motion_along(path, along):
    """(time) -> the same of a motion on a path: (time) -> place, speed and acceleration on it."""

    def motion(at):
        place, speed, acceleration = along(at)
        slope, bend = path(place, 1), path(place, 2)
        return path(place), slope * speed, slope * acceleration + bend * speed**2

    return motion


def _text(numbers):
    return " ".join(repr(float(number)) for number in numbers)
