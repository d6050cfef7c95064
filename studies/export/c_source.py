"""Moves as C without dependencies: a plan, or the table of a sweep with its interpolation."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

import casadi as ca
import numpy as np
from quietarm.models.joint_motion import joint_unit
from quietarm.ocp import Plan
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.studies.report.templates import templates
from quietarm.studies.report.words import limit_words, move_of, moved
from quietarm.studies.sweep.grid import OF_MOVES
from quietarm.studies.sweep.interpolation import ORDERS
from quietarm.studies.sweep.library import MoveLibrary

_HELPER = re.compile(r"^double casadi_\w+\([^)]*\) \{.*?\}$", re.M | re.S)
_STATEMENTS = re.compile(r"^static int casadi_f0\([^)]*\) \{\n(.*?)\n  return 0;", re.M | re.S)
"""What CasADi's generator writes: small functions, and the body of the first function."""


def c_files(moves: Plan | MoveLibrary, name: str) -> tuple[str, str]:
    """Header and source whose functions are called after a file's name."""
    if not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII):
        raise ValueError(
            f"{name}.c would hold a function {name}_at, which is no name in C; give a file name "
            "of letters, digits and _ that begins with a letter"
        )
    words = _words_of_plan(moves) if isinstance(moves, Plan) else _words_of_library(moves)
    task = moves.task if isinstance(moves, Plan) else moves.grid.task
    words["unit"] = joint_unit("rad", task.plant.joint)
    words["way"] = f"{'angle' if words['unit'] == 'rad' else 'position'} [{words['unit']}]"
    words["title"] = words["title"].replace("*/", "")
    words["helpers"], words["statements"] = _path_in_c(moves.profile)
    texts = templates(keep_trailing_newline=True)
    texts.filters["row"] = _row
    header, source = (
        texts.get_template(f"export/templates/move.{kind}")
        .render(name=name, upper=name.upper(), size=moves.profile.size, **words)
        for kind in "hc"
    )  # fmt: skip
    return header, source


def _words_of_plan(plan: Plan) -> dict[str, Any]:
    return {
        "title": f"{moved(plan.task)}, {move_of(plan.task)}",
        "version": plan.record.versions.get("quietarm", ""),
        "figures": ", ".join([
            f"Energy {plan.energy:.4g} J, residual {1e3 * plan.residual:.3g} mm",
            *limit_words(plan.task),
        ]),
        "axes": (), "given": "", "move": [repr(value) for value in plan.task.move],
        "coefficients": plan.coefficients,
    }  # fmt: skip


def _words_of_library(library: MoveLibrary) -> dict[str, Any]:
    axes, between = library.grid.axes, library.interpolation
    names = [axis.name for axis in axes]
    of_move = dict(zip(OF_MOVES, map(repr, library.grid.task.move), strict=True))
    parameters = [f"double {name}, " for name in names if name in OF_MOVES]
    return {
        "title": f"moves of {moved(library.grid.task)}",
        "version": library.store.note("versions").get("quietarm", ""),
        "figures": library.between().words.capitalize(),
        "axes": between.axes, "lengths": between.lengths, "most": max(ORDERS),
        "units": [f"{axis.name} [{axis.unit}]" for axis in axes],
        "places": ", ".join(f"double at_{name}" for name in names),
        "place_names": ", ".join(f"at_{name}" for name in names),
        "given": f"const double coefficients[{library.profile.size}], {''.join(parameters)}",
        "move": [name if name in names else value for name, value in of_move.items()],
        "orders": between.orders.reshape(-1, between.orders.shape[-1]),
        "cells": np.nan_to_num(between.cells).reshape(-1, library.profile.size),
    }  # fmt: skip


def _path_in_c(profile: JointProfile) -> tuple[list[str], str]:
    """Functions that are called, and the statements of the joint's path, by CasADi's generator."""
    fraction, a, move = ca.SX.sym("t"), ca.SX.sym("a", profile.size), ca.SX.sym("move", 3)
    joint = profile.motion(ca.vertsplit(a), fraction, *ca.vertsplit(move), jerk=False)
    results = ca.densify(ca.vertcat(joint.angle, joint.speed, joint.acceleration))
    generator = ca.CodeGenerator("path", {"with_export": False})
    generator.add(ca.Function("path", [fraction, a, move], [results], {"cse": True}))
    text = generator.dump().replace("casadi_real", "double")
    found = _STATEMENTS.search(text)
    assert found is not None
    return _HELPER.findall(text), found[1]


def _row(values: Iterable[float]) -> str:
    """Constants of C with every digit."""
    return ", ".join(repr(float(value)) for value in values)
