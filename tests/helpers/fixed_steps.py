"""A motion's figures by `symbolic_rollout` in numbers, with the plant's scenarios one by one."""

from functools import lru_cache
from types import SimpleNamespace

import casadi as ca
import numpy as np

from quietarm.ocp import Figures, FreeVibration, symbolic_rollout
from quietarm.ocp.limits import QUANTITIES
from quietarm.ocp.simulation.mesh import default_steps
from quietarm.ocp.simulation.objective import integrated


@lru_cache(maxsize=64)
def _compiled(plant, profile, steps, breaks, energy):
    """(coefficients, row) -> quantities at the nodes, angles, arrival, energy, net work."""
    a, row = ca.MX.sym("a", profile.size), ca.MX.sym("row", 3 + 2 * plant.modes)
    *move, initial = ca.vertsplit(row, [0, 1, 2, 3, row.numel()])
    found = symbolic_rollout(
        plant, profile, ca.vertsplit(a), move, steps, jerk=True, breaks=breaks,
        initial=ca.vertsplit(initial), energy=energy,
    )  # fmt: skip
    quantities = [
        ca.vertcat(*(value for sample in found.samples for value in quantity.values(sample)))
        for quantity in QUANTITIES.values()
    ]
    angles = ca.vertcat(*(sample.path.angle for sample in found.samples))
    net_work = integrated(found.power, found.h)
    outputs = [*quantities, angles, found.arrival, found.energy, net_work]
    return ca.Function("rollout", [a, row], outputs)


def _of_scenario(task, plant, profile, coefficients, steps):
    function = _compiled(plant, profile, steps, profile.breaks(task.duration), task.energy)
    found = function.call([ca.DM(profile.checked(coefficients, task.duration)), ca.DM(task.row)])
    *quantities, angles, arrival, energy, net_work = (one.full() for one in found)
    vibration = FreeVibration(plant, task.target, task.residual_window)
    past_target = (angles - task.target) * np.sign(task.span)
    peaks = zip(QUANTITIES.values(), quantities, strict=True)
    motion = {
        "residual": float(np.abs(vibration.rows @ task.missed(arrival.ravel())).max()),
        "energy": energy.item(),
        "net_work": net_work.item(),
        "overshoot": max(0.0, past_target.max()),
        **{one.peak: float(np.abs(values).max()) for one, values in peaks},
    }
    return motion, arrival.ravel()


def rollout(task, profile, coefficients, steps=None):
    """Motion, arrival and steps, with the residual at the samples of a population.

    Residual and deflection are the worst of all scenarios.
    """
    steps = default_steps(task) if steps is None else steps
    each = [
        _of_scenario(task, plant, profile, coefficients, steps) for plant in task.perturbed_plants
    ]
    residual, deflection = (
        max(motion[name] for motion, _ in each) for name in ("residual", "peak_deflection")
    )
    motion = Figures({**each[0][0], "residual": residual, "peak_deflection": deflection})
    return SimpleNamespace(motion=motion, arrival=each[0][1], steps=steps)
