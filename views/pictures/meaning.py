"""The meaning of a motion in the words of the grammar of pictures."""

from __future__ import annotations

from quietarm.ocp import CycloidPolynomial, Floor, JudgedMotion, Plan
from quietarm.ocp.profiles.shaped_cycloid import ShapedCycloid


def meaning_of(motion: Plan | Floor | JudgedMotion) -> str:
    """Name which of `MEANINGS` a motion is, or what else, such as a shaper "MZV"."""
    if isinstance(motion, Floor):
        return "floor"
    if is_plain_cycloid(motion):
        return "plain cycloid"
    if isinstance(motion.profile, ShapedCycloid):
        return motion.profile.shaper.upper()
    if isinstance(motion, JudgedMotion):
        return ""
    return "robust plan" if motion.task.ranges else "plan"


def is_plain_cycloid(motion: Plan | JudgedMotion) -> bool:
    """Return whether a motion is the plain cycloid, whose coefficients are all zero."""
    return (
        isinstance(motion, Plan)
        and isinstance(motion.profile, CycloidPolynomial)
        and not any(motion.coefficients)
    )
