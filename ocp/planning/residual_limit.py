"""The residual limit of a task: what is given, or the default."""

from __future__ import annotations

from typing import NamedTuple

from quietarm.ocp.checks import not_negative
from quietarm.ocp.robustness import quiet_residual
from quietarm.ocp.task import PointToPoint


class ResidualLimit(NamedTuple):
    """The largest residual of a plan [m], and whether it may be lowered or raised.

    Of an uncertain task the default is only where the search for a limit begins.
    """

    size: float
    adapts: bool = False

    @classmethod
    def of(cls, task: PointToPoint, given: float | None) -> ResidualLimit:
        """The limit that is given, or the default: rest, or `quiet_residual` of an uncertain task.

        ValueError where it is negative, or that of an uncertain task is 0.
        """
        if given is not None:
            given = not_negative("residual limit", given, "m")
        if task.uncertainty is None:
            return cls(given or 0.0)
        size = quiet_residual(task) if given is None else given
        if size > 0:
            return cls(size, adapts=given is None)
        if given is None:
            raise ValueError(
                "the plain cycloid does not bend this plant, so that 5 % of that is no limit; give "
                "a residual limit above 0"
            )
        raise ValueError(
            "residual limit is 0, but no motion arrives at rest in all scenarios; omit it "
            "(default: 5 % of the plain cycloid's largest deflection) or give one above 0"
        )
