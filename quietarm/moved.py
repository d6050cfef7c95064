"""Names of 2.0 that have moved: where they are is said for a year, until the end of 2027."""

from __future__ import annotations

from collections.abc import Sequence
from types import ModuleType

MOVED = {"figures": "quietarm.pictures", "Candidate": "quietarm.JudgedMotion"}
"""Names of `qa`."""
MOVED_WITHIN = {
    "models": {"joint_unit": "quietarm.models.dimensions.WAY.of(kind)"},
    "ocp": {
        "Motion": "quietarm.ocp.Figures",
        "Candidate": "quietarm.ocp.JudgedMotion",
        "Worst": "quietarm.ocp.JudgedMotion, which has errors and residual",
    },
    "pictures": {"QUANTITIES_DRAWN": "quietarm.pictures.drawn_quantities()"},
    "compare": {"JudgedMotion": "quietarm.compare.ComparedMotion"},
    "studies": {
        "figures": "quietarm.views.pictures",
        "identify": "quietarm.machine.identify",
        "export": "quietarm.views",
    },
}
"""Names of its packages."""

ROOMS = {
    "models.checks": "models.number_checks",
    "models.robot.beam": "models.robot.elastic.beam",
    "models.robot.cartesian": "models.robot.path.straight_line",
    "models.robot.files": "models.robot.text_files",
    "models.robot.flexibility": "models.robot.elastic.flexibility",
    "models.robot.full": "models.robot.on_path.full",
    "models.robot.mechanism": "models.robot.dynamics.mechanism",
    "models.robot.modes": "models.robot.dynamics.modes",
    "models.robot.piecewise": "models.robot.path.piecewise",
    "models.robot.reduction": "models.robot.on_path.reduction",
    "models.robot.spectra": "models.robot.elastic.spectra",
    "models.robot.stick_figure": "models.robot.on_path.robot_figure",
    "models.robot.tables": "models.robot.on_path.path_tables",
    "metaheuristics.gradient": "metaheuristics.methods.gradient_methods",
    "metaheuristics.user_method": "metaheuristics.methods.user_method",
    "metaheuristics.objective": "metaheuristics.evaluation",
    "metaheuristics.algorithms.presets": "metaheuristics.methods.presets",
    "metaheuristics.algorithms.settings": "metaheuristics.methods.settings",
    "metaheuristics.algorithms.building": "metaheuristics.methods.building",
    "studies.identify": "machine.identify",
    "studies.figures": "views.pictures",
    "studies.report": "views.report",
    "studies.export": "views",
    "studies.explore": "views.explore",
    "studies.reading": "studies.answers",
    "studies.sweep.grid": "studies.sweep.move_grid",
    "studies.sweep.cells": "studies.sweep.grid_cells",
    "studies.sweep.interpolation": "studies.sweep.cell_interpolation",
    "studies.reproduce.report": "studies.reproduce.paper_report",
    "studies.bench.page": "studies.bench.bench_page",
    "studies.bench.figures": "studies.bench.bench_pictures",
    "ocp.candidate": "ocp.judged_motion",
    "studies.compare.judged_motions": "studies.compare.compared_motions",
    "ocp.planning.setup": "ocp.planning.request",
    "ocp.front.curve": "ocp.front.tradeoff",
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
        if name != room and room in ROOMS:
            raise ImportError(f"{name} has moved to quietarm.{ROOMS[room]}", name=name)
