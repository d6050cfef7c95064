"""The paper's claims, each with the figures that support or refute it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from quietarm.ocp import Plan
from quietarm.studies.paper.case import Case
from quietarm.studies.paper.printed import Row
from quietarm.studies.reproduction.pieces import BEYOND_SIX, STUDIED
from quietarm.studies.reproduction.recompute import Reproduction

_AT_REST = 1e-7
"""A residual below this [m] counts as cancelled."""
_GAIN = 0.01
"""A fall of the energy by more than this share counts as a gain."""


@dataclass(frozen=True)
class Claim:
    """A claim of the paper, whether the figures bear it out, and those figures."""

    text: str
    holds: bool
    evidence: tuple[str, ...]

    @property
    def verdict(self) -> str:
        """Whether the figures bear the claim out: supported, or refuted."""
        return "supported" if self.holds else "refuted"


def claims(result: Reproduction) -> list[Claim]:
    """Judge the paper's claims by the recomputed figures."""
    return [
        _two_terms_suffice(result),
        _more_terms_lower_the_energy(result),
        _no_gain_above_six(result),
        _beats_the_earlier_studies(result),
        _tuned_to_the_optimum(result),
    ]


def _name(condition: Case) -> str:
    return f"{condition.task.plant.name} {condition.label}"


def _best_printed(result: Reproduction, condition: Case, terms: int) -> Plan:
    plan = result.result(condition, terms).mended_or_printed
    if plan is None:
        raise KeyError((condition, terms))
    return plan


def _two_terms_suffice(result: Reproduction) -> Claim:
    evidence: list[str] = []
    holds = True
    for condition in STUDIED:
        cycloid = result.cycloids[condition]
        printed = _best_printed(result, condition, 2)
        gradient = result.more_terms[condition, 2, True]
        holds = holds and gradient.residual < _AT_REST
        evidence.append(
            f"{_name(condition)}: {cycloid.residual * 1e3:.2f} mm with the plain cycloid, "
            f"{printed.residual * 1e3:.2f} mm with the two printed coefficients, "
            f"{gradient.residual * 1e3:.1e} mm with the gradient's two"
        )
    return Claim("Two terms suffice to cancel the residual vibration.", holds, tuple(evidence))


def _more_terms_lower_the_energy(result: Reproduction) -> Claim:
    evidence: list[str] = []
    holds = True
    for condition in STUDIED:
        for name, plans in (
            ("printed coefficients", [_best_printed(result, condition, n) for n in (2, 4, 6)]),
            ("gradient in the box", [result.more_terms[condition, n, True] for n in (2, 4, 6)]),
        ):
            energies = [plan.energy for plan in plans]
            holds = holds and all(more < fewer for fewer, more in pairwise(energies))
            evidence.append(
                f"{_name(condition)}, {name}, N = 2, 4, 6: "
                + ", ".join(f"{energy:.4f}" for energy in energies)
                + " J"
            )
    return Claim("More terms lower the energy.", holds, tuple(evidence))


def _no_gain_above_six(result: Reproduction) -> Claim:
    evidence: list[str] = []
    holds = True
    for condition in STUDIED:
        for boxed, name in ((True, "in the paper's box"), (False, "without a box")):
            six = result.more_terms[condition, 6, boxed].energy
            gains = {
                terms: 1 - result.more_terms[condition, terms, boxed].energy / six
                for terms in BEYOND_SIX
            }
            holds = holds and all(gain <= _GAIN for gain in gains.values())
            evidence.append(
                f"{_name(condition)}, gradient {name}: {six:.4f} J at N = 6; "
                + ", ".join(f"{gain:.1%} less at N = {n}" for n, gain in gains.items())
            )
    return Claim("The energy does not fall further above six terms.", holds, tuple(evidence))


def _against_earlier(result: Reproduction) -> list[tuple[Row, float, float]]:
    """Rows with an earlier study's energy: row, that energy, and the gradient's in the box [J]."""
    return [
        (found.row, found.row.earlier_energy, found.in_box.energy)
        for found in result.rows
        if found.row.earlier_energy is not None
    ]


def _beats_the_earlier_studies(result: Reproduction) -> Claim:
    rows = _against_earlier(result)
    evidence = tuple(
        f"{_name(row.condition)}: printed {row.energy:.3g} J against {earlier:.3g} J of "
        f"ref. [{23 if row.table == 3 else 24}]; the gradient needs {gradient:.4g} J in the same "
        "box"
        for row, earlier, gradient in rows
    )
    holds = all(row.energy < earlier for row, earlier, _ in rows)
    return Claim("The proposed method beats refs [23] and [24].", holds, evidence)


def _tuned_to_the_optimum(result: Reproduction) -> Claim:
    rows = _against_earlier(result)
    evidence = tuple(
        f"{_name(row.condition)}: the printed {row.energy:.3g} J is "
        f"{row.energy / gradient - 1:.1%} above what the gradient needs in the same box, at rest "
        "on arrival"
        for row, _, gradient in rows
    )
    holds = all(row.energy / gradient - 1 <= _GAIN for row, _, gradient in rows)
    return Claim(
        "The tuned coefficients are optimal in their search space (implied).", holds, evidence
    )
