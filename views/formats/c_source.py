"""Moves as C without dependencies: a plan, or the table of a sweep with its interpolation."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from quietarm.models import Plant
from quietarm.models.dimensions import WAY
from quietarm.ocp import Plan
from quietarm.ocp.escapes import c_comment, c_string
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.task import OF_MOVES
from quietarm.views.formats.between_rows import note_of_calls
from quietarm.views.formats.exact_path import (
    figures_of,
    path_function,
    positions_at,
    title_of,
)
from quietarm.views.formats.export_format import (
    DATASET,
    PLAN,
    Answers,
    Exported,
    ExportFormat,
    Progress,
    values_of,
)
from quietarm.views.formats.row_settings import CYCLE
from quietarm.views.report.templates import templates
from quietarm.views.report.words import moved, window_words

if TYPE_CHECKING:
    from quietarm.studies.sweep.library import MoveLibrary

_HELPER = re.compile(r"^double casadi_\w+\([^)]*\) \{.*?\}$", re.M | re.S)
_STATEMENTS = re.compile(r"^static int casadi_f0\([^)]*\) \{\n(.*?)\n  return 0;", re.M | re.S)
"""What CasADi's generator writes: small functions, and the body of the first function."""


class CSource(ExportFormat):
    """The motion at any time from the coefficients, with nothing but math.h."""

    name = "c"
    endings = (".c",)
    beside = (".h",)
    meaning = "C source"
    of_the_load = True
    takes = (PLAN, DATASET)
    settings = (CYCLE,)

    def check_path(self, path: Path) -> None:
        """Refuse a name that no function can have."""
        name = path.stem
        if not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII):
            raise ValueError(
                f"{name}.c would hold a function {name}_at, which is no name in C; give a file "
                "name of letters, digits and _ that begins with a letter"
            )

    def export(
        self, answers: Answers, path: Path, report: Progress, *args: Any, cycle: float,
        **others: Any,
    ) -> Exported:  # fmt: skip
        """Header and source."""
        (moves,) = values_of(answers)
        header, source = _c_files(moves, path.stem)
        notes = [note_of_calls(moves, cycle)] if isinstance(moves, Plan) else []
        return Exported({path.with_suffix(".h"): header, path: source}, notes)


def _c_files(moves: Plan | MoveLibrary, name: str) -> tuple[str, str]:
    """Header and source whose functions are called after a file's name."""
    if isinstance(moves, Plan):
        task = moves.task
        versions = moves.record.versions
        between = None
        axes = ()
        title = title_of(moves)
        figures = figures_of(moves)
    else:
        task = moves.grid.task
        versions = moves.store.note("versions")
        between = moves.interpolation
        axes = moves.grid.axes
        title = f"moves of {moved(task)}"
        figures = moves.between().words
        figures += f", residuals {window_words(task.residual_window)}"
    move = dict(zip(OF_MOVES, map(repr, task.move)))
    plant = task.plant
    names = plant.joint_names if plant.has_path else ()
    helpers, statements = _path_in_c(moves.profile, plant)
    ends = [positions_at(plant, place) for place in (task.start, task.target)] if names else []
    texts = templates(keep_trailing_newline=True)
    texts.filters |= {"row": _row, "string": c_string, "comment": c_comment}
    header, source = (
        texts.get_template(f"views/formats/templates/move.{kind}").render(
            name=name, upper=name.upper(), size=moves.profile.size, title=title,
            figures=figures[0].upper() + figures[1:], version=versions.get("quietarm", ""),
            unit=WAY.of(task.plant.joint), axes=axes, between=between,
            most=between and between.most_cells,
            move=move | {axis.name: axis.name for axis in axes if axis.name in move},
            coefficients=() if between else moves.coefficients, helpers=helpers,
            statements=statements, no_plan=np.nan_to_num, joints=names, ends=ends,
        )
        for kind in "hc"
    )  # fmt: skip
    return header, source


def _path_in_c(profile: JointProfile, plant: Plant) -> tuple[list[str], str]:
    """Functions that are called, and the statements of the joints' path, by CasADi's generator."""
    generator = ca.CodeGenerator("path", {"with_export": False})
    generator.add(path_function(profile, plant))
    text = generator.dump().replace("casadi_real", "double")
    match = _STATEMENTS.search(text)
    assert match is not None
    return _HELPER.findall(text), match[1]


def _row(values: Iterable[float]) -> str:
    """Constants of C with every digit."""
    return ", ".join(repr(float(value)) for value in values)
