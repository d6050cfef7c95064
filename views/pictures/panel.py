"""A panel of one's own, beside those that pictures of motions have."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp import Floor, Plan
from quietarm.ocp.checks import failed_in, known, quoted

Array = NDArray[np.float64]


class Panel(ABC):
    """A panel over time: a name, a title, and the values that it draws.

    A class beside a plant in its `--plant-file`, or anywhere in Python, is drawn by `motion_figure`
    and by every command that draws a motion, once it is defined. `draw_quantity(plan, name, ax)`
    draws it alone.

    Raises
    ------
    ValueError
        When a subclass has a name without a title.
    """

    name: ClassVar[str]
    """What it is asked for by."""
    title: ClassVar[str]
    """Above the panel, with the unit: bending moment [N m]."""

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if isinstance(vars(cls).get("name"), str) and not isinstance(
            getattr(cls, "title", None), str
        ):
            raise ValueError(
                f"panel {cls.name} has no title; give one, as title = 'bending moment [N m]'"
            )

    @abstractmethod
    def values(self, motion: Plan | Floor) -> Any:
        """What is drawn at the times of ``motion.trajectory``, whose `sample` has the motion.

        An array of a value each time; or several arrays by what the legend calls them.
        """

    def fits(self, motion: Plan | Floor) -> bool:
        """Whether a picture of this motion has the panel unasked; by default every one."""
        del motion
        return True

    def curves(self, motion: Plan | Floor) -> dict[str, Array]:
        """The values by what the legend calls them; ValueError where its own lines fail."""
        try:
            found = self.values(motion)
            named = found if isinstance(found, Mapping) else {"": found}
            curves = {str(name): np.asarray(value, float) for name, value in named.items()}
        except Exception as error:
            raise failed_in(f"panel {self.name}", type(self), error) from error
        times = motion.trajectory.time
        for curve in curves.values():
            if curve.shape != times.shape:
                raise ValueError(
                    f"panel {self.name} has values of shape {curve.shape} at {len(times)} times; "
                    "return a number each time of motion.trajectory"
                )
        return curves


def known_panels(shipped: tuple[str, ...]) -> dict[str, Panel]:
    """The user's panels by name; ValueError where one has the name of a shipped quantity."""
    panels = {name: kind() for name, kind in known(Panel).items()}
    for name, panel in panels.items():
        if name in shipped:
            raise ValueError(
                f"name {quoted(name)} of {type(panel).__name__} is that of a panel of quietarm's; "
                "give another"
            )
    return panels
