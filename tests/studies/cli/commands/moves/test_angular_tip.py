"""A drive of two masses, whose tip turns: its displacement is in rad wherever it is shown."""

import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from quietarm.models import load_plant_file
from quietarm.ocp import Front, Plan
from quietarm.studies.compare import compare_plans
from quietarm.views.pictures import draw_motions, front_figure

pytestmark = pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")

# A motor and a load on a shaft: W is the load's angle, seen from the motor. By Newton's law of the
# load, load (theta'' + W'') = -stiffness W - ..., and of both, torque = all theta'' + load W''.
DRIVE = '''
from dataclasses import dataclass
from typing import ClassVar

import quietarm as qa


@dataclass(frozen=True)
class TwoMassDrive(qa.Plant):
    """A motor that turns a load by a shaft."""

    name: ClassVar[str] = "two-mass-drive"
    modes: ClassVar[int] = 1
    tip_unit: ClassVar[str] = "rad"

    omega: float = qa.parameter(20.0, "rad/s", "of a test", "frequency, motor held")
    zeta: float = qa.parameter(0.01, "-", "of a test", "damping ratio")
    motor: float = qa.parameter(0.02, "kg m^2", "of a test", "inertia of the motor")
    load: float = qa.parameter(0.03, "kg m^2", "of a test", "inertia of the load")
    friction: float = qa.parameter(0.05, "N m s", "of a test", "of the motor")

    def modal_accelerations(self, joint, W, dW):
        own = -2 * self.zeta * self.omega * dW[0] - self.omega**2 * W[0]
        return [own - joint.acceleration]

    def torque(self, joint, W, dW, ddW):
        inertia = (self.motor + self.load) * joint.acceleration
        return inertia + self.load * ddW[0] + self.friction * joint.speed

    def tip_displacements(self, W):
        return [W[0]]
'''
MOVE = "two-mass-drive --plant-file drive.py --target 180deg --duration 0.4"
LENGTH = re.compile(r"\bmm\b|[\d\]] m\b")


@pytest.fixture
def drive():
    Path("drive.py").write_text(DRIVE)
    return load_plant_file("drive.py")


@pytest.mark.slow
@pytest.mark.usefixtures("drive")
def test_a_move_of_it_has_rad_on_the_screen_and_in_files(done, folder):
    out = done(
        f"evaluate {MOVE} --coefficients 0 --deflection-limit 30deg --initial 0.01:0 "
        "--quiet --sensitivities --output plan.json --output move.csv --output move.png"
    )
    plan = Plan.load("plan.json")
    assert f"{plan.residual:.3g} rad at the tip" in out
    assert f"peak deflection {plan.motion.peak_deflection:.3g} rad" in " ".join(out.split())
    assert "deflection 0.523599 rad (broken" in out
    assert "W 0.01 rad, W' 0 rad/s" in out
    assert not LENGTH.search(out)
    header, *_ = Path("move.csv").read_text().splitlines()
    assert header.split(",")[4] == "tip_rad"
    done("export plan.json --output turned.csv --columns time,tip:deg --rate 100 --quiet")
    header, *rows = Path("turned.csv").read_text().splitlines()
    assert header == "time_s,tip_deg"
    degrees = np.degrees(plan.sampled(np.arange(41) / 100).tips[:, 0])
    assert [float(row.split(",")[1]) for row in rows] == pytest.approx(degrees, abs=1e-8)
    done("export plan.json --output move.c")
    assert f"residual {plan.residual:.3g} rad" in Path("move.h").read_text()


@pytest.mark.slow
@pytest.mark.usefixtures("drive")
def test_a_limit_of_its_residual_is_an_angle(done, refused):
    out = done(f"plan {MOVE} --terms 4 --starts 1 --residual-limit 1deg --output plan.json --quiet")
    assert "limits residual 0.0175 rad" in " ".join(out.split())
    assert not LENGTH.search(out)
    assert Plan.load("plan.json").residual_limit == pytest.approx(np.pi / 180)
    said = refused(f"plan {MOVE} --residual-limit 1mm")
    assert "'1mm' is not an angle; give radians (0.5), 30deg" in said


@pytest.mark.slow
@pytest.mark.usefixtures("drive")
def test_plans_and_fronts_are_compared_in_rad(done):
    done(f"plan {MOVE} --terms 4 --starts 1 --output plan.json --quiet")
    line = "compare plan.json --plant-file drive.py --baselines zv --error frequency=5%"
    out = done(f"{line} --output compared")
    assert "residual [rad]" in out
    assert "worst case [rad]" in out
    assert not LENGTH.search(out)
    out = done(f"front {MOVE} --terms 3 --points 4 --output f.json --output f.csv --quiet")
    assert "rad" in out
    assert not LENGTH.search(out)
    assert Path("f.csv").read_text().startswith("residual_rad,energy_J,a_1")
    front = Front.load("f.json")
    out = done("compare f.json --plant-file drive.py --output fronts")
    assert not LENGTH.search(out)
    with pytest.raises(ValueError, match="residual of 0 rad or less; give at least the"):
        front.cheapest(0.0)


@pytest.mark.slow
@pytest.mark.usefixtures("drive")
def test_a_residual_in_rad_has_its_window(done):
    window = "--residual-window 3s --quiet"
    out = done(f"evaluate {MOVE} --coefficients 0 {window} --output plan.json")
    plan = Plan.load("plan.json")
    assert f"{plan.residual:.3g} rad at the tip within 3 s" in out
    done("export plan.json --output move.c")
    assert f"residual {plan.residual:.3g} rad within 3 s" in Path("move.h").read_text()
    done(f"front {MOVE} --terms 3 --points 4 {window} --output f.json --output f.csv")
    header, *rows = Path("f.csv").read_text().splitlines()
    assert header == "residual_rad,energy_J,a_1,a_2,a_3,residual_window_s"
    assert {row.split(",")[-1] for row in rows} == {"3.0"}
    front = Front.load("f.json")
    label = "residual within 3 s [rad]"
    assert front_figure([front]).axes[0].get_xlabel() == label
    assert label in front._repr_html_()
    motions = compare_plans({"mine": plan})
    assert draw_motions(motions, tip_unit="rad").get_xlabel() == label
    done(f"sweep {MOVE},0.5s --terms 3 {window} --output moves.zarr --output moves.png")
    dataset = xr.open_zarr("moves.zarr", consolidated=False)
    assert dataset.residual.attrs["units"] == "rad"
    assert dataset.residual.attrs["residual_window_s"] == 3.0
