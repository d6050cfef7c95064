"""Claims of the paper, in its order, each with a table of what decides it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.stats import wilcoxon

from quietarm.ocp import Plan
from quietarm.studies.reproduce.paper import (
    ARM_HALF,
    SINGLE_LINK_SIXTH,
    SIX,
    STUDIED,
    Case,
    PaperRow,
    paper_plan,
)
from quietarm.studies.reproduce.recompute import BEYOND_SIX, Reproduction
from quietarm.studies.reproduce.searched import OLD_CONSTANTS, SIX_TERMS, Searched
from quietarm.views.report.words import spread_words

_GAIN = 0.01
"""Energies that differ by more than this share differ."""
_PRINTED = (2, 4, 6)
"""Numbers of terms of the paper's coefficients."""


Outcome = tuple[Any, pd.DataFrame]
"""Whether a claim holds, and the table that says so."""


@dataclass(frozen=True, eq=False)
class Verdict:
    """The verdict on a claim, and the table that decides it."""

    claim: str
    holds: bool
    evidence: pd.DataFrame

    @property
    def word(self) -> str:
        """Verdict in a word."""
        return "holds" if self.holds else "does not hold"


def claims(result: Reproduction) -> list[Verdict]:
    """Judge the paper's claims; ValueError where it was recomputed without `full`."""
    if not result.effort.full:
        raise ValueError("the claims need Effort(full=True); recompute the paper with it")
    judged = ((claim, *judge(result)) for claim, judge in _CLAIMS.items())
    return [Verdict(claim, bool(holds), evidence) for claim, holds, evidence in judged]


_Judge = Callable[[Reproduction], Outcome]
_CLAIMS: dict[str, _Judge] = {}


def _claim(words: str) -> Callable[[_Judge], _Judge]:
    """A claim, and what judges it: whether it holds, and the table that says so."""
    return lambda judge: _CLAIMS.setdefault(words, judge)


def _paper(case: Case, terms: int) -> Plan:
    plan = paper_plan(case, terms)
    assert plan is not None  # of the conditions studied the paper prints all
    return plan


def _tip_peak(plan: Plan) -> float:
    """Largest displacement of the tip during the move [mm]."""
    return 1e3 * plan.motion.peak_deflection


def _largest_torque(plan: Plan, begin: float, end: float) -> float:
    """The largest torque between two shares of the duration [N m]."""
    share = plan.trajectory.time / plan.task.duration
    return float(np.abs(plan.trajectory.torque[(share > begin) & (share <= end)]).max())


def _words(search: Searched) -> str:
    """Median, quartiles, and how many seeds come within the level."""
    energy = f"{spread_words(search.energies, '.4f')} J" if search.energies.count else "no motion"
    return f"{energy} within {search.level * 1e3:.2g} mm"


def _by_terms(
    result: Reproduction, cases: Sequence[Case], of: Callable[[Plan], float], name: str
) -> tuple[NDArray[np.float64], pd.DataFrame]:
    """A figure of the printed coefficients and of the gradient's, by number of terms."""
    by = {"printed": _paper, "gradient in the box": result.in_box}
    rows = [
        (case.name, way, *(of(by[way](case, n)) for n in _PRINTED)) for case in cases for way in by
    ]
    columns = ["condition", name, *(f"N = {n}" for n in _PRINTED)]
    table = pd.DataFrame(rows, columns=columns)
    return table.iloc[:, 2:].to_numpy(), table


def _falls(values: NDArray[np.float64], table: pd.DataFrame) -> Outcome:
    return (np.diff(values, axis=1) < 0).all(), table


@_claim("Two terms suffice to cancel the residual vibration.")
def _two_terms(result: Reproduction) -> Outcome:
    # a residual below this [m] counts as cancelled
    at_rest = 1e-7
    table = pd.DataFrame(
        {
            "condition": case.name,
            "plain cycloid [mm]": 1e3 * result.cycloid(case).residual,
            "two printed [mm]": 1e3 * _paper(case, 2).residual,
            "gradient's two [mm]": 1e3 * result.in_box(case, 2).residual,
            "searched": f"{case.search_label}: {_words(result.searched[case, 2])}",
        }
        for case in STUDIED
    )
    return table["gradient's two [mm]"].max() < 1e3 * at_rest, table


@_claim("The plain cycloid needs torque to hold the joint after arrival, the plans none (Fig. 2d).")
def _holding(result: Reproduction) -> Outcome:
    # share of the plain cycloid's holding torque below which there is none to speak of
    no_torque = 0.01
    case = SINGLE_LINK_SIXTH
    plans = {"plain cycloid": result.cycloid(case)} | {
        f"N = {n}": _paper(case, n) for n in _PRINTED
    }
    plain, *holding = (_largest_torque(plan, 1.0, np.inf) for plan in plans.values())
    table = pd.DataFrame([(case.name, plain, *holding)], columns=["torque [N m]", *plans])
    return max(holding) <= no_torque * plain, table


@_claim("More terms lower the tip's largest displacement on the way (Fig. 2c).")
def _link_tip(result: Reproduction) -> Outcome:
    return _falls(*_by_terms(result, [SINGLE_LINK_SIXTH], _tip_peak, "displacement [mm]"))


@_claim("More terms lower the energy.")
def _energy(result: Reproduction) -> Outcome:
    return _falls(*_by_terms(result, STUDIED, lambda plan: plan.energy, "energy [J]"))


@_claim("The energy does not fall further above six terms.")
def _beyond_six(result: Reproduction) -> Outcome:
    terms = (SIX_TERMS, *BEYOND_SIX)
    rows = list[tuple[Any, ...]]()
    for case in STUDIED:
        medians = [result.searched[case, n].energies.median for n in terms]
        rows += [
            (case.name, "gradient in the box", *(result.in_box(case, n).energy for n in terms)),
            (case.name, "gradient without one", *(result.free(case, n).energy for n in terms)),
            *([(case.name, f"{case.search_label}, medians", *medians)] * all(np.isfinite(medians))),
        ]
    columns = ["condition", "energy [J]", *(f"N = {n}" for n in terms)]
    table = pd.DataFrame(rows, columns=columns)
    six, *beyond = table.iloc[:, 2:].to_numpy().T
    return all((1 - energy / six <= _GAIN).all() for energy in beyond), table


@_claim("The tip's largest displacement is smaller than with the network of ref. [23] (Fig. 3c).")
def _network_tip(result: Reproduction) -> Outcome:
    case = SINGLE_LINK_SIXTH
    network = result.searched[case, case.earlier[1]].middle
    peaks = {
        "paper, N = 6 [mm]": _tip_peak(_paper(case, SIX_TERMS)),
        "network, searched [mm]": np.inf if network is None else _tip_peak(network),
        "gradient in the box, N = 6 [mm]": _tip_peak(result.in_box(case, SIX_TERMS)),
    }
    paper, searched, _ = peaks.values()
    return paper < searched, pd.DataFrame([{"condition": case.name, **peaks}])


@_claim("On the arm the tip's largest displacement is much the same for all numbers of terms (5c).")
def _arm_tip(result: Reproduction) -> Outcome:
    # peaks that differ by no more than this factor count as alike
    alike = 1.2
    values, table = _by_terms(result, [ARM_HALF], _tip_peak, "displacement [mm]")
    return (values.max(axis=1) <= alike * values.min(axis=1)).all(), table


@_claim("With four and six terms the arm's torque rises rapidly after starting (Fig. 5d).")
def _early_torque(result: Reproduction) -> Outcome:
    early = 0.05  # 'immediately after starting', as a share of the duration
    rapid = 2.0  # so many times the torque of N = 2 is a rapid increase
    name = f"torque in the first {early:.0%} of the move [N m]"
    values, table = _by_terms(
        result, [ARM_HALF], lambda plan: _largest_torque(plan, -1.0, early), name
    )
    return (values[:, 1:] > rapid * values[:, :1]).all(), table


@_claim("The motion of ref. [24] is like that of two terms (Fig. 6).")
def _paths(result: Reproduction) -> Outcome:
    case = ARM_HALF
    times = np.linspace(0.0, ARM_HALF.task.duration, 201)
    network = result.searched[case, case.earlier[1]]
    path = np.nan if network.middle is None else network.middle.path(times)
    two, six = (np.sqrt(np.mean((path - _paper(case, n).path(times)) ** 2)) for n in (2, SIX_TERMS))
    row = {
        "condition": case.name,
        f"{case.earlier[1]}, searched": _words(network),
        "path from N = 2, rms [rad]": two,
        "path from N = 6, rms [rad]": six,
    }
    return not two >= six, pd.DataFrame([row])


def _six(
    result: Reproduction, cells: Callable[[PaperRow, Searched, Searched], dict[str, Any]]
) -> pd.DataFrame:
    """A table of the six conditions: of the paper's row, and its search with both inputs."""
    rows = list[dict[str, Any]]()
    for row in SIX:
        case = row.condition
        earlier, six = (result.searched[case, of] for of in (case.earlier[1], SIX_TERMS))
        rows.append({"condition": case.name, **cells(row, earlier, six)})
    return pd.DataFrame(rows)


@_claim("Six parameters leave as little vibration as sixteen.")
def _vibration(result: Reproduction) -> Outcome:
    table = _six(
        result,
        lambda row, earlier, six: {
            "within [mm]": 1e3 * six.level,
            "seeds": six.energies.seeds,
            "with six terms": six.energies.count,
            "with the earlier input": earlier.energies.count,
        },
    )
    return (table["with six terms"] >= table["with the earlier input"]).all(), table


@_claim("The proposed method beats refs [23] and [24], as printed.")
def _as_printed(result: Reproduction) -> Outcome:
    table = _six(
        result,
        lambda row, earlier, six: {
            "paper, printed [J]": row.energy,
            "earlier study, printed [J]": row.earlier_energy,
        },
    )
    return (table["paper, printed [J]"] < table["earlier study, printed [J]"]).all(), table


@_claim("The same search finds less energy with six terms than with the earlier inputs.")
def _same_search(result: Reproduction) -> Outcome:
    table = _six(
        result,
        lambda row, earlier, six: {
            "six terms": _words(six),
            "earlier input": f"{earlier.which}: {_words(earlier)}",
            "less": six.energies.median < earlier.energies.median,
        },
    )
    return table["less"].all(), table


@_claim("The printed energies are below what the paper's own search finds with the earlier inputs.")
def _earlier_inputs(result: Reproduction) -> Outcome:
    table = _six(
        result,
        lambda row, earlier, six: {
            "paper, printed [J]": row.energy,
            "earlier input": f"{earlier.which}: {_words(earlier)}",
            "less": row.energy < earlier.energies.median,
        },
    )
    return table["less"].all(), table


@_claim("The energy of Table 3 hangs neither on seeds nor on constants of VEPSO (implied).")
def _choices(result: Reproduction) -> Outcome:
    case = SINGLE_LINK_SIXTH
    printed = SIX[0].energy
    standard = result.searched[case, SIX_TERMS]
    old = result.searched[case, OLD_CONSTANTS]
    half = replace(standard, fronts=standard.fronts[: (len(standard.fronts) + 1) // 2])
    rows = list[dict[str, Any]]()
    searches = {
        "all": standard,
        "the first": half,
        "with constants of 2002": old,
    }
    for name, search in searches.items():
        energies = np.array([front.least_energy(search.level) for front in search.fronts])
        excess = np.nan_to_num(energies, nan=10 * printed) - printed
        rows.append(
            {
                case.search_label: name,
                "seeds": len(energies),
                "energy": _words(search),
                "above the printed": int((excess > 0).sum()),
                "Wilcoxon's p of the printed": wilcoxon(excess)[1] if len(excess) > 1 else None,
            }
        )
    agree = rows[0]["above the printed"] in (0, rows[0]["seeds"])
    return agree and old.energies.median <= printed, pd.DataFrame(rows)


@_claim("Networks cost more to compute.")
def _cost(result: Reproduction) -> Outcome:
    # the fastest seed: others may have shared their core
    # times that differ by no more than this factor are alike
    alike = 1.05
    table = pd.DataFrame(
        {
            "fastest seed of": f"{case.name}, {case.search_label}",
            "six terms [s]": min(result.searched[case, SIX_TERMS].seconds),
            "earlier input [s]": min(result.searched[case, case.earlier[1]].seconds),
        }
        for case in STUDIED
    )
    return (table["earlier input [s]"] > alike * table["six terms [s]"]).all(), table


@_claim("The tuned coefficients are optimal in their search space (implied).")
def _tuned(result: Reproduction) -> Outcome:
    energies = {row: result.in_box(row.condition, SIX_TERMS).energy for row in SIX}
    table = _six(
        result,
        lambda row, earlier, six: {
            "paper, printed [J]": row.energy,
            "gradient in the box [J]": energies[row],
            "above [%]": 100 * (row.energy / energies[row] - 1),
        },
    )
    return table["above [%]"].max() <= 100 * _GAIN, table
