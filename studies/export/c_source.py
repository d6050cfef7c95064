"""A move as C: angle, speed and acceleration of the joint at any time, without dependencies."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

import casadi as ca
from quietarm.ocp import Plan
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.studies.display.templates import templates
from quietarm.studies.display.words import move_of, moved

_OPERATIONS = {
    ca.OP_ADD: "{0} + {1}", ca.OP_SUB: "{0} - {1}", ca.OP_MUL: "{0} * {1}", ca.OP_DIV: "{0} / {1}",
    ca.OP_NEG: "-{0}", ca.OP_SQ: "{0} * {0}", ca.OP_TWICE: "2.0 * {0}", ca.OP_INV: "1.0 / {0}",
    ca.OP_SIN: "sin({0})", ca.OP_COS: "cos({0})", ca.OP_TAN: "tan({0})", ca.OP_TANH: "tanh({0})",
    ca.OP_EXP: "exp({0})", ca.OP_LOG: "log({0})", ca.OP_SQRT: "sqrt({0})", ca.OP_ERF: "erf({0})",
    ca.OP_POW: "pow({0}, {1})", ca.OP_CONSTPOW: "pow({0}, {1})", ca.OP_FABS: "fabs({0})",
    ca.OP_FMIN: "fmin({0}, {1})", ca.OP_FMAX: "fmax({0}, {1})", ca.OP_ASSIGN: "{0}",
    ca.OP_LT: "{0} < {1}", ca.OP_LE: "{0} <= {1}", ca.OP_EQ: "{0} == {1}", ca.OP_NE: "{0} != {1}",
    ca.OP_NOT: "{0} == 0.0", ca.OP_AND: "{0} != 0.0 && {1} != 0.0",
    ca.OP_OR: "{0} != 0.0 || {1} != 0.0", ca.OP_IF_ELSE_ZERO: "{0} != 0.0 ? {1} : 0.0",
    ca.OP_SINH: "sinh({0})", ca.OP_COSH: "cosh({0})", ca.OP_ATAN: "atan({0})",
}  # fmt: skip
"""What casadi's operations are in C."""
_RESULTS = ("*angle", "*speed", "*acceleration")


def c_files(plan: Plan, name: str) -> tuple[str, str]:
    """Header and source whose function is called after a file's name."""
    name_in_c(name)
    given = [*plan.coefficients, *plan.task.move]
    return rendered(
        "move", name, *statements(plan.profile, ["t", *map(number, given)]),
        move=f"{moved(plan.task)}, {move_of(plan.task)}".replace("*/", ""),
        version=plan.provenance.versions.get("quietarm", ""),
        figures=", ".join([
            f"energy {plan.energy:.4g} J, residual {1e3 * plan.residual:.3g} mm",
            *(f"{limit.name} within {limit.bounds}" for limit in plan.task.limits),
        ]),
        values=plan.task.move,
    )  # fmt: skip


def name_in_c(name: str) -> None:
    """Refuse a file's name after which no function can be called."""
    if not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII):
        raise ValueError(
            f"{name}.c would hold a function {name}_at, which is no name in C; give a file name "
            "of letters, digits and _ that begins with a letter"
        )


def rendered(
    template: str, name: str, variables: Sequence[str], lines: Sequence[str], **words: object
) -> tuple[str, str]:
    """Header and source of a template beside this file."""
    texts = templates(keep_trailing_newline=True)
    texts.filters.update(c=number, row=_row)
    words |= {"name": name, "guard": name.upper(), "variables": variables, "lines": lines}
    header, source = (
        texts.get_template(f"export/templates/{template}.{kind}").render(words) for kind in "hc"
    )
    return header, source


def statements(profile: JointProfile, inputs: Sequence[str]) -> tuple[list[str], list[str]]:
    """The variables, and a statement for each operation of the joint's path.

    Inputs are what C calls the share of the duration, each coefficient, start, target and duration.
    """
    fraction, a, move = ca.SX.sym("t"), ca.SX.sym("a", profile.size), ca.SX.sym("move", 3)
    start, target, duration = ca.vertsplit(move)
    joint = profile.motion(ca.vertsplit(a), fraction, start, target, duration, jerk=False)
    results = ca.vertcat(joint.angle, joint.speed, joint.acceleration)
    given = ca.vertcat(fraction, a, move)
    path = ca.Function("path", [given], [ca.densify(results)], {"cse": True})
    lines, variables = list[str](), dict[str, None]()
    for k in range(path.n_instructions()):
        operation, to = path.instruction_id(k), path.instruction_output(k)
        operands = [f"v{i}" for i in path.instruction_input(k)]
        if operation == ca.OP_OUTPUT:
            lines.append(f"{_RESULTS[to[1]]} = {operands[0]};")
            continue
        variables[f"v{to[0]}"] = None
        if operation == ca.OP_INPUT:
            value = inputs[path.instruction_input(k)[1]]
        elif operation == ca.OP_CONST:
            value = number(path.instruction_constant(k))
        else:
            value = _OPERATIONS[operation].format(*operands)
        lines.append(f"v{to[0]} = {value};")
    return list(variables), lines


def number(value: float) -> str:
    """A constant of C with every digit."""
    return repr(float(value))


def _row(values: Iterable[float]) -> str:
    return ", ".join(map(number, values))
