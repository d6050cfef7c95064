"""A plant at one time: what limits, energies, figures and exports read."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import NamedTuple

import casadi as ca

from quietarm.models import Expression, JointMotion, Plant
from quietarm.models.joint_motion import Modes
from quietarm.ocp.energy import power_of


class Sample(NamedTuple):
    """Motion and torques of a plant at one time, or at many in arrays of one shape.

    Attributes
    ----------
    path : JointMotion
        The motion along the path; of a plant of one joint the joint's own.
    joints : sequence of JointMotion
        The motion of every joint [rad, rad/s, rad/s^2, rad/s^3].
    W, dW, ddW : sequence
        Modal amplitudes [m], their rates [m/s] and accelerations [m/s^2].
    tips : sequence
        Displacements of the tips [m].
    torques : sequence
        Torque of every joint [N m].
    plant : Plant or None
        Of which it is: what only some ask for follows from it.
    """

    path: JointMotion
    joints: Sequence[JointMotion]
    W: Modes
    dW: Modes
    ddW: Modes
    tips: Sequence[Expression]
    torques: Sequence[Expression]
    plant: Plant | None = None

    @property
    def tip_speeds(self) -> Sequence[Expression]:
        """Time derivatives of the tips' displacements [m/s]."""
        assert self.plant is not None
        return self.plant.tip_speeds(self.path, self.W, self.dW)

    @property
    def tip_accelerations(self) -> Sequence[Expression]:
        """Second time derivatives of the tips' displacements [m/s^2]."""
        assert self.plant is not None
        return self.plant.tip_accelerations(self.path, self.W, self.dW, self.ddW)

    @property
    def powers(self) -> list[Expression]:
        """Mechanical power of every joint [W]."""
        return [power_of(torque, joint.speed) for torque, joint in zip(self.torques, self.joints)]

    @property
    def power(self) -> Expression:
        """Mechanical power of all joints together [W]."""
        return total(self.powers)

    @property
    def values(self) -> list[Expression]:
        """Every value, in the order of the attributes; a jerk that is None is left out."""
        motions = [value for joint in (self.path, *self.joints) for value in joint]
        columns = [*self.W, *self.dW, *self.ddW, *self.tips, *self.torques]
        return [value for value in motions if value is not None] + columns

    def with_values(self, values: Iterable[Expression]) -> Sample:
        """Return this sample with other `values`."""
        following = iter(values)

        def motion(joint: JointMotion) -> JointMotion:
            return JointMotion(*(None if value is None else next(following) for value in joint))

        def entries(values: Sequence[Expression]) -> list[Expression]:
            return [next(following) for _ in values]

        return Sample(
            path=motion(self.path),
            joints=[motion(joint) for joint in self.joints],
            W=entries(self.W),
            dW=entries(self.dW),
            ddW=entries(self.ddW),
            tips=entries(self.tips),
            torques=entries(self.torques),
            plant=self.plant,
        )


def sample_plant(plant: Plant, path: JointMotion, W: Modes, dW: Modes, ddW: Modes) -> Sample:
    """The sample of a plant by its equations; arguments as of `Plant.torque`."""
    return Sample(
        path=path,
        joints=plant.joints(path),
        W=W,
        dW=dW,
        ddW=ddW,
        tips=plant.tips_at(path, W),
        torques=plant.driving_torques(path, W, dW, ddW),
        plant=plant,
    )


@lru_cache(maxsize=256)
def symbolic_sample(plant: Plant) -> Sample:
    """A sample of symbols, which tells how many values of each kind the plant has."""
    path = JointMotion(*(ca.SX.sym(name) for name in JointMotion._fields))
    modes = [ca.vertsplit(ca.SX.sym(name, plant.modes)) for name in ("W", "dW", "ddW")]
    return sample_plant(plant, path, *modes)


def total(values: Sequence[Expression]) -> Expression:
    """Return the sum of values; of one it is the value itself, so nothing has to be computed."""
    first, *following = values
    for value in following:
        first = first + value
    return first
