"""A move as a function block in Structured Text, for a PLC after IEC 61131-3."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import casadi as ca

from quietarm.models.dimensions import WAY
from quietarm.ocp import Plan
from quietarm.ocp.escapes import st_comment, st_number
from quietarm.views.formats.between_rows import note_of_calls
from quietarm.views.formats.exact_path import figures_of, path_function, positions_at, title_of
from quietarm.views.formats.export_format import (
    Answers,
    Exported,
    ExportFormat,
    ExportSetting,
    Progress,
    values_of,
)
from quietarm.views.formats.row_settings import CYCLE
from quietarm.views.report.templates import templates

_DIGITS = {"LREAL": 17, "REAL": 9}
"""Types of real numbers, and the digits that tell two of them apart."""
_MOVE = ("Start", "Target", "Duration")
"""What the last argument of `path_function` is called in the block."""
_OPERATIONS: Mapping[int, str] = {
    ca.OP_ASSIGN: "{0}",
    ca.OP_ADD: "{0} + {1}",
    ca.OP_SUB: "{0} - {1}",
    ca.OP_MUL: "{0} * {1}",
    ca.OP_DIV: "{0} / {1}",
    ca.OP_NEG: "-{0}",
    ca.OP_SQ: "{0} * {0}",
    ca.OP_TWICE: "2.0 * {0}",
    ca.OP_INV: "1.0 / {0}",
    ca.OP_SQRT: "SQRT({0})",
    ca.OP_SIN: "SIN({0})",
    ca.OP_COS: "COS({0})",
    ca.OP_TAN: "TAN({0})",
    ca.OP_ASIN: "ASIN({0})",
    ca.OP_ACOS: "ACOS({0})",
    ca.OP_ATAN: "ATAN({0})",
    ca.OP_EXP: "EXP({0})",
    ca.OP_LOG: "LN({0})",
    ca.OP_TANH: "1.0 - 2.0 / (EXP(2.0 * {0}) + 1.0)",
    ca.OP_FABS: "ABS({0})",
    ca.OP_FMIN: "MIN({0}, {1})",
    ca.OP_FMAX: "MAX({0}, {1})",
    ca.OP_POW: "EXPT({0}, {1})",
    ca.OP_CONSTPOW: "EXPT({0}, {1})",
    # a truth value is 1.0 or 0.0
    ca.OP_LT: "SEL({0} < {1}, 0.0, 1.0)",
    ca.OP_LE: "SEL({0} <= {1}, 0.0, 1.0)",
    ca.OP_EQ: "SEL({0} = {1}, 0.0, 1.0)",
    ca.OP_NE: "SEL({0} <> {1}, 0.0, 1.0)",
    ca.OP_NOT: "SEL({0} = 0.0, 0.0, 1.0)",
    ca.OP_AND: "SEL({0} <> 0.0 AND {1} <> 0.0, 0.0, 1.0)",
    ca.OP_OR: "SEL({0} <> 0.0 OR {1} <> 0.0, 0.0, 1.0)",
    ca.OP_IF_ELSE_ZERO: "SEL({0} <> 0.0, 0.0, {1})",
}
"""CasADi's operations in Structured Text."""


class StructuredText(ExportFormat):
    """The motion at any time from the coefficients, started and timed as PLCopen has it."""

    name = "st"
    endings = (".st",)
    meaning = "a function block in Structured Text"
    of_the_load = True
    settings = (
        CYCLE,
        ExportSetting("real", "LREAL", "Type of real numbers: LREAL, or REAL of a small PLC."),
    )

    def check_path(self, path: Path) -> None:
        """Refuse a name that no function block can have."""
        if not re.fullmatch(r"[A-Za-z0-9]+(_[A-Za-z0-9]+)*", path.stem, re.ASCII):
            raise ValueError(
                f"{path.stem}.st would hold a function block FB_{path.stem}, which is no name in "
                "IEC 61131-3; give a file name of letters, digits and single _"
            )

    def export(
        self, answers: Answers, path: Path, report: Progress, *args: Any, cycle: float, real: str,
        **others: Any,
    ) -> Exported:  # fmt: skip
        """Write the block, whose name is FB_ and the file's."""
        (plan,) = values_of(answers)
        if real not in _DIGITS:
            raise ValueError(f"real is {real!r}; give {' or '.join(_DIGITS)}")
        notes = [note_of_calls(plan, cycle)]
        return Exported({path: _block(plan, f"FB_{path.stem}", real)}, notes)


def _block(plan: Plan, name: str, real: str) -> str:
    """Return the source of a function block."""

    def number(value: float) -> str:
        return st_number(value, _DIGITS[real])

    task = plan.task
    plant = task.plant
    function = path_function(plan.profile, plant)
    size = function.numel_out(0) // 3
    outputs = ("Position", "Velocity", "Acceleration")
    places = [f"{output}[{joint + 1}]" if size > 1 else output for output in outputs
              for joint in range(size)]  # fmt: skip
    statements, variables = _statements(function, places, number)
    start, target = (positions_at(plant, place) for place in (task.start, task.target))
    texts = templates(keep_trailing_newline=True)
    texts.filters |= {"comment": st_comment, "number": number}
    return texts.get_template("views/formats/templates/move.st").render(
        name=name, title=title_of(plan), figures=figures_of(plan), real=real, size=size,
        version=plan.record.versions.get("quietarm", ""), start=start, target=target,
        joints=[(joint, WAY.of(kind)) for joint, kind in zip(plant.joint_names, plant.joint_kinds)],
        coefficients=list(plan.coefficients) or [0.0], move=dict(zip(_MOVE, task.move)),
        statements=statements, variables=variables,
    )  # fmt: skip


def _statements(
    function: ca.Function, places: list[str], number: Callable[[float], str]
) -> tuple[list[str], list[str]]:
    """Return the assignments that evaluate a function, and the variables that they need."""
    width = len(str(function.sz_w()))
    names = [f"w{place:0{width}}" for place in range(function.sz_w())]
    lines = list[str]()
    used = set[int]()
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        given = function.instruction_input(k)
        into = function.instruction_output(k)
        if operation == ca.OP_OUTPUT:
            lines.append(f"{places[into[1]]} := {names[given[0]]};")
            continue
        if operation == ca.OP_INPUT:
            argument, place = given
            value = ("Fraction", f"Coefficients[{place}]", _MOVE[place % 3])[argument]
        elif operation == ca.OP_CONST:
            value = number(function.instruction_constant(k))
        elif operation in _OPERATIONS:
            value = _OPERATIONS[operation].format(*(names[place] for place in given))
        else:
            raise ValueError(
                f"the path needs operation {operation} of CasADi, which Structured Text does not "
                "have; export .c, or .csv as a table"
            )
        used.add(into[0])
        lines.append(f"{names[into[0]]} := {value};")
    return lines, [names[place] for place in sorted(used)]
