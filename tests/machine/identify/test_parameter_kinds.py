"""Which parameters are frequencies and dampings of modes is declared, whatever their names are."""

import math
from pathlib import Path

import numpy as np
import pytest

import quietarm as qa
from quietarm.models import known_plants, load_plant_file

pytestmark = pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")

# W'' = -2 ratio rate W' - rate^2 W - theta'' for the mode; of the shaft's damper nothing is sought.
PLANT = '''
from dataclasses import dataclass
from typing import ClassVar

import quietarm as qa


@dataclass(frozen=True)
class Mast(qa.Plant):
    """A mast on a motor."""

    name: ClassVar[str] = "mast"
    modes: ClassVar[int] = 1

    rate: float = qa.parameter(20.0, "rad/s", "of a test")
    {damping}
    damping: float = qa.parameter(0.5, "N m s/rad", "of a test", "of the shaft")
    cutoff: float = qa.parameter(300.0, "rad/s", "of a test", "of the drive", kind="other")

    def modal_accelerations(self, joint, W, dW):
        own = -2 * self.{name} * self.rate * dW[0] - self.rate**2 * W[0]
        return [own - joint.acceleration]

    def torque(self, joint, W, dW, ddW):
        return 2.0 * joint.acceleration + self.damping * joint.speed + ddW[0]

    def tip_displacements(self, W):
        return [W[0]]
'''


def mast(name="ratio", kind=', kind="damping"'):
    damping = f'{name}: float = qa.parameter(0.02, "-", "of a test"{kind})'
    Path("mast.py").write_text(PLANT.format(damping=damping, name=name))
    return load_plant_file("mast.py")["mast"]()


def ringing():
    """A swing of 21 rad/s and damping 0.03, as it is by the solution of the equation."""
    time = np.arange(0, 4, 0.01)
    swing = np.exp(-0.03 * 21 * time) * np.cos(21 * math.sqrt(1 - 0.03**2) * time)
    noise = 0.01 * np.random.default_rng(0).standard_normal(len(time))
    return qa.Recording(time, tip=0.02 * (swing + noise), name="push")


def test_a_users_plant_declares_them_by_any_name(folder):
    found = qa.identify([ringing()], mast())
    values = {one.parameter: one.value for one in found.estimates}
    assert values == {
        "rate": pytest.approx(21, rel=1e-3), "ratio": pytest.approx(0.03, rel=0.05)
    }  # fmt: skip


def test_a_name_alone_declares_nothing_and_the_refusal_says_what_to_write(folder):
    undeclared = mast("zeta", kind="")
    words = r"mast does not say what zeta is; write it with qa.parameter\(..., kind='damping'\)"
    for free in (None, ["rate", "zeta"]):
        with pytest.raises(ValueError, match=words):
            qa.identify([ringing()], undeclared, free)


def test_what_is_no_damping_ratio_is_no_share(folder, done, call):
    mast()
    typed = "evaluate mast --plant-file mast.py --target 1 --duration 2 --coefficients 0"
    done(f"{typed} --set damping=2 --set ratio=3%")
    status, _, err = call(f"{typed} --set ratio=3")
    assert status == 2
    assert "ratio=3 is 300 %" in err


def test_every_damping_ratio_that_is_shipped_is_declared():
    """The damping ratios are those of the equations in docs/physics.md and docs/linear_axis.md."""
    declared = {
        name: [one for one, kind in plant.parameter_kinds().items() if kind == "damping"]
        for name, plant in known_plants().items()
    }
    assert declared.items() >= {
        "single-link": ["zeta"], "arm-on-flexible-link": ["zeta"], "flexible-beam": ["zeta"],
        "dual-link": ["zeta1", "zeta2"], "linear-axis": ["zeta1", "zeta2"], "robot": [],
    }.items()  # fmt: skip


def test_another_kind_is_refused():
    with pytest.raises(ValueError, match="kind is 'loss'; give 'frequency', 'damping' or 'other'"):
        qa.parameter(1.0, "-", "of a test", kind="loss")
