"""The base class of a user's own panel in pictures of motions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp import Floor, Plan
from quietarm.ocp.checks import failed_in, forgotten_if_refused, known, object_of, quoted

Array = NDArray[np.float64]


class Panel(ABC):
    """A user's own panel over time: a class with a `name`, a `title` and `values`.

    `motion_figure` and every command that draws a motion include it as soon as it is defined, in a
    `--plant-file` or anywhere in Python. `draw_quantity(plan, name, ax)` draws it alone.

    Raises
    ------
    ValueError
        If a subclass has a name and no title.
    """

    name: ClassVar[str]
    """The name for `draw_quantity` and `motion_figure`."""
    title: ClassVar[str]
    """The title with its unit, such as bending moment [N m]."""

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        named = isinstance(vars(cls).get("name"), str)
        with forgotten_if_refused(cls):
            if named and not isinstance(getattr(cls, "title", None), str):
                raise ValueError(
                    f"panel {cls.name} has no title; give one, as title = 'bending moment [N m]'"
                )
            if named and cls.values is Panel.values:
                raise ValueError(f"panel {cls.name} draws nothing; define values(self, motion)")

    @abstractmethod
    def values(self, motion: Plan | Floor) -> Any:
        """Return the values at the times of ``motion.trajectory``, whose `sample` has the motion.

        One array of a value for each time, or a mapping of such arrays by their labels.
        """

    def fits(self, motion: Plan | Floor) -> bool:
        """Return True if pictures of this motion include the panel by default."""
        del motion
        return True

    def curves(self, motion: Plan | Floor) -> dict[str, Array]:
        """Return the curves by their labels; ValueError if its code fails."""
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
    """Return the user's panels by name; ValueError if one has the name of a shipped quantity."""
    panels: dict[str, Panel] = {name: object_of(kind) for name, kind in known(Panel).items()}
    for name, panel in panels.items():
        if name in shipped:
            raise ValueError(
                f"name {quoted(name)} of {type(panel).__name__} is that of a panel of quietarm's; "
                "give another"
            )
    return panels
