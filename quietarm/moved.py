"""Names of 2.0 that have moved: where they are is said for a year, until the end of 2027."""

from __future__ import annotations

from collections.abc import Sequence
from types import ModuleType

MOVED = {"figures": "pictures"}
"""Names of `qa`."""

_ROOMS = {
    "studies.identify": "machine.identify",
    "studies.identify.signals": "machine.recordings",
    "studies.figures": "views.pictures",
    "studies.report": "views.report",
    "studies.export": "views",
    "studies.explore": "views.page",
    "studies.reading": "studies.answers",
    "studies.tips": "views.tips",
}


class MovedRooms:
    """Answers, after all other finders, an import of a room that has moved."""

    @staticmethod
    def find_spec(
        name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> None:
        """Nothing of other modules; ImportError with the room's place now."""
        room = name.removeprefix("quietarm.")
        if name != room and room in _ROOMS:
            raise ImportError(f"{name} has moved to quietarm.{_ROOMS[room]}", name=name)
