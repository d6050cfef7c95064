"""The contract of a plant, checked before anything is computed with it.

`calls` calls each method as the program does and checks what it returns; `values` computes that
over a turn and more of joint angles, moving and at rest; `along` over a move. May import the plant
and the joint's motion.
"""

from __future__ import annotations

from dataclasses import Field, is_dataclass
from functools import lru_cache
from inspect import getattr_static

from models.contract.calls import MOST, is_number
from models.contract.values import Equations
from models.plant import Plant


def check_contract(plant: Plant) -> None:
    """Check all that `Plant` asks of its subclasses.

    Parameters
    ----------
    plant : Plant
        The plant.

    Raises
    ------
    ValueError
        With the method, what it gives and what it should return.
    """
    _check_class(plant)
    _check_equations(plant)


def _check_class(plant: Plant) -> None:
    kind, called = type(plant), repr(plant.name)
    bare = any(isinstance(entry, Field) for entry in vars(kind).values())
    if bare or not is_dataclass(plant) or kind.__hash__ is None:
        raise ValueError(
            f"plant {called} is no frozen dataclass; write @dataclass(frozen=True) above class "
            f"{kind.__name__}"
        )
    for name in ("parameters", "parts", "tips"):
        if not isinstance(getattr_static(kind, name), property):
            raise ValueError(
                f"plant {called} has {name} of its own, a name that Plant needs; call it otherwise"
            )
    modes: object = getattr(plant, "modes", None)
    if isinstance(modes, bool) or not isinstance(modes, int) or modes < 1:
        has = "no modes" if modes is None else f"{modes!r} modes"
        raise ValueError(
            f"plant {called} has {has}; write how many it has, 1 or more, as "
            "modes: ClassVar[int] = 1"
        )
    if modes > MOST:
        raise ValueError(f"plant {called} has {modes} modes; give at most {MOST}")
    small = plant.small_deflection
    if small is not None and not (is_number(small) and small > 0):
        raise ValueError(
            f"plant {called}: small_deflection is {small!r}; give a length in m, or None"
        )


@lru_cache(maxsize=256)
def _check_equations(plant: Plant) -> None:
    """The check of the equations; a plant that has passed is not checked again."""
    equations = Equations(plant)
    equations.check_linear()
    equations.check_one_by_one()
    equations.check_finite()
    equations.check_rest()
    equations.check_tips()
    equations.check_stable()
    equations.check_torque()
    equations.check_numbers()
