"""What the paper claims, in its order, judged by the recomputed figures."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp import Plan
from quietarm.studies.document.blocks import Verdict
from quietarm.studies.paper import ARM_HALF, CONDITIONS, EARLIER, SINGLE_LINK_SIXTH, Case
from quietarm.studies.reproduction.recompute import Reproduction
from quietarm.studies.reproduction.searches import (
    BEYOND_SIX,
    COMPARED_TERMS,
    STUDIED,
    Searched,
    earlier_input,
    own_search,
)

Array = NDArray[np.float64]
_AT_REST = 1e-7
"""A residual below this [m] counts as cancelled."""
_GAIN = 0.01
"""A fall of the energy by more than this share counts as a gain."""
_NO_TORQUE = 0.01
"""Share of the plain cycloid's holding torque below which there is none to speak of."""
_ALIKE = 0.2
"""Peaks that differ by no more than this share count as alike."""
_EARLY = 0.05
"""Share of the duration that is 'immediately after starting'."""
_RAPID = 2.0
"""So many times the torque of N = 2 is a rapid increase."""
_DEARER = 0.05
"""Times that differ by no more than this share are alike."""
_TERMS = (2, 4, 6)
"""Numbers of terms of the paper's coefficients."""


def claims(result: Reproduction) -> list[Verdict]:
    """Judge the paper's claims."""
    return [
        _two_terms_suffice(result),
        _nothing_to_hold(result),
        _tip_peak_falls(result),
        _more_terms_lower_the_energy(result),
        _no_gain_above_six(result),
        _tip_peak_below_network(result),
        _like_peaks(result),
        _early_torque(result),
        _gaussians_like_two_terms(result),
        _as_still_with_fewer_parameters(result),
        _beats_what_is_printed(result),
        _beats_like_for_like(result),
        _networks_cost_more(result),
        _tuned(result),
    ]


def _name(condition: Case) -> str:
    return f"{condition.task.plant.name} {condition.label}"


def _printed(result: Reproduction, condition: Case, terms: int) -> Plan:
    plan = result.result(condition, terms).mended_or_printed
    assert plan is not None  # of the conditions studied the paper prints all
    return plan


def _searched(found: Searched) -> str:
    """Median and quartiles of the energies within the level, and how many seeds came there."""
    spread, limit = found.energies, f"within {found.level * 1e3:.2g} mm"
    if spread.seeds == 1:
        return f"{spread.median:.4f} J {limit}" if spread.count else f"nothing {limit}"
    arrived = f"{spread.count} of {spread.seeds} seeds {limit}"
    if not np.isfinite(spread.median):
        return f"no median ({arrived})"
    low, high = (f"{q:.4f}" if np.isfinite(q) else "none" for q in (spread.lower, spread.upper))
    return f"median {spread.median:.4f} J (quartiles {low} and {high}, {arrived})"


def _over_terms(
    result: Reproduction,
    cases: Sequence[Case],
    of: Callable[[Plan], float],
    claim: str,
    holds: Callable[[list[float]], bool],
    words: str,
) -> Verdict:
    """Judge a figure of the printed coefficients and of the gradient, by number of terms."""
    figures: dict[str, list[float]] = {}
    for case in cases:
        printed = (_printed(result, case, n) for n in _TERMS)
        boxed = (result.more_terms[case, n, True] for n in _TERMS)
        figures[f"{_name(case)}, printed coefficients"] = [of(plan) for plan in printed]
        figures[f"{_name(case)}, gradient in the box"] = [of(plan) for plan in boxed]
    return Verdict(
        claim,
        all(holds(each) for each in figures.values()),
        [f"{name}, N = 2, 4, 6: {words.format(*each)}" for name, each in figures.items()],
    )


def _falls(values: list[float]) -> bool:
    return all(more < fewer for fewer, more in pairwise(values))


def _two_terms_suffice(result: Reproduction) -> Verdict:
    gradient = {case: result.more_terms[case, 2, True].residual for case in STUDIED}
    return Verdict(
        "Two terms suffice to cancel the residual vibration.",
        max(gradient.values()) < _AT_REST,
        [
            f"{_name(case)}: {result.cycloids[case].residual * 1e3:.2f} mm with the plain cycloid, "
            f"{_printed(result, case, 2).residual * 1e3:.2f} mm with the two printed coefficients, "
            f"{left * 1e3:.1e} mm with the gradient's two; {own_search(case).label}: "
            f"{_searched(result.experiment[case, 2])}"
            for case, left in gradient.items()
        ],
    )


def _largest_torque(plan: Plan, when: Callable[[Array], NDArray[np.bool_]]) -> float:
    """The largest torque at some of the times, which are shares of the duration [N m]."""
    motion = plan.trajectory
    return float(np.abs(motion.torque[when(motion.time / plan.task.duration)]).max())


def _nothing_to_hold(result: Reproduction) -> Verdict:
    case = SINGLE_LINK_SIXTH
    plans = [result.cycloids[case], *(_printed(result, case, n) for n in _TERMS)]
    plain, *held = (_largest_torque(plan, lambda time: time > 1) for plan in plans)
    return Verdict(
        "The plain cycloid needs torque to hold the joint after arrival, the plans none (Fig. 2d).",
        max(held) <= _NO_TORQUE * plain,
        [
            f"{_name(case)}: {plain:.3f} N m with the plain cycloid; "
            "{:.4f}, {:.4f}, {:.4f} N m with the printed coefficients, N = 2, 4, 6".format(*held)
        ],
    )


def _tip_peak(plan: Plan) -> float:
    """Largest displacement of the tip during the move [mm]."""
    return 1e3 * plan.motion.peak_deflection


def _tip_peak_falls(result: Reproduction) -> Verdict:
    claim = "More terms lower the tip's largest displacement on the way (Fig. 2c)."
    words = "{:.1f}, {:.1f}, {:.1f} mm"
    return _over_terms(result, [SINGLE_LINK_SIXTH], _tip_peak, claim, _falls, words)


def _more_terms_lower_the_energy(result: Reproduction) -> Verdict:
    claim, words = "More terms lower the energy.", "{:.4f}, {:.4f}, {:.4f} J"
    return _over_terms(result, STUDIED, lambda plan: plan.energy, claim, _falls, words)


def _difference(gain: float) -> str:
    if not np.isfinite(gain):
        return "most seeds do not arrive"
    return f"{abs(gain):.1%} {'less' if gain >= 0 else 'more'}"


def _no_gain_above_six(result: Reproduction) -> Verdict:
    evidence: list[str] = []
    holds = True

    def judge(name: str, six: float, beyond: Iterable[float]) -> None:
        nonlocal holds
        gains = dict(zip(BEYOND_SIX, (1 - energy / six for energy in beyond), strict=True))
        holds = holds and max(gains.values()) <= _GAIN
        words = ", ".join(f"{_difference(gain)} at N = {n}" for n, gain in gains.items())
        evidence.append(f"{name}: {six:.4f} J at N = 6; {words}")

    for case in STUDIED:
        for boxed, name in ((True, "in the paper's box"), (False, "without a box")):
            six, *beyond = (result.more_terms[case, n, boxed].energy for n in (6, *BEYOND_SIX))
            judge(f"{_name(case)}, gradient {name}", six, beyond)
        searched = [result.experiment[case, n].energies for n in (6, *BEYOND_SIX)]
        median = "" if searched[0].seeds == 1 else " (medians)"
        label = f"{_name(case)}, {own_search(case).label}{median}"
        six, *beyond = (spread.median for spread in searched)
        if np.isfinite(six):
            judge(label, six, beyond)
    return Verdict("The energy does not fall further above six terms.", holds, evidence)


def _tip_peak_below_network(result: Reproduction) -> Verdict:
    case = SINGLE_LINK_SIXTH
    name, method = earlier_input(case), own_search(case).label
    paper = _tip_peak(_printed(result, case, COMPARED_TERMS))
    network = result.experiment[case, name].middle
    evidence = [f"{_name(case)}: {paper:.1f} mm with the printed coefficients, N = 6"]
    if network is not None:
        evidence.append(f"{_tip_peak(network):.1f} mm with the {name} by {method}, middle seed")
    by_gradient = result.result(case, COMPARED_TERMS).in_box
    evidence.append(f"{_tip_peak(by_gradient):.1f} mm with the gradient's six in the box")
    return Verdict(
        f"The tip's largest displacement is smaller than with the {name} of ref. [23] (Fig. 3c).",
        network is None or paper < _tip_peak(network),
        evidence,
    )


def _like_peaks(result: Reproduction) -> Verdict:
    return _over_terms(
        result, [ARM_HALF], _tip_peak,
        "On the arm the tip's largest displacement is much the same for all numbers of terms (5c).",
        lambda each: max(each) <= (1 + _ALIKE) * min(each),
        "{:.2f}, {:.2f}, {:.2f} mm; plain cycloid "
        f"{_tip_peak(result.cycloids[ARM_HALF]):.2f} mm",
    )  # fmt: skip


def _early_torque(result: Reproduction) -> Verdict:
    return _over_terms(
        result, [ARM_HALF], partial(_largest_torque, when=lambda time: time <= _EARLY),
        "With four and six terms the arm's torque rises rapidly after starting (Fig. 5d).",
        lambda each: min(each[1:]) > _RAPID * each[0],
        f"{{:.3f}}, {{:.3f}}, {{:.3f}} N m in the first {_EARLY:.0%} of the move",
    )  # fmt: skip


def _gaussians_like_two_terms(result: Reproduction) -> Verdict:
    case = ARM_HALF
    name = earlier_input(case)
    gaussians = result.experiment[case, name].middle
    row = result.result(case, 2).row
    (earlier,) = {r.row.earlier_energy for r in result.rows if r.row.condition == case} - {None}
    evidence = [f"{_name(case)}: printed {earlier:.3g} J of [24], {row.energy:.3g} J for N = 2"]
    holds = True
    if gaussians is not None:
        times = np.linspace(0.0, case.task.duration, 201)

        def apart(terms: int) -> float:
            difference = gaussians.path(times) - _printed(result, case, terms).path(times)
            return float(np.sqrt(np.mean(difference**2)))

        two, six = apart(2), apart(6)
        holds = two < six
        evidence.append(
            f"the joint's path with the {name} by {own_search(case).label}, middle seed, is "
            f"{two:.3f} rad (rms) from that of the printed N = 2, {six:.3f} rad from N = 6"
        )
    return Verdict("The motion of ref. [24] is like that of two terms (Fig. 6).", holds, evidence)


def _as_still_with_fewer_parameters(result: Reproduction) -> Verdict:
    def arrived(found: Searched) -> str:
        return f"{found.energies.count} of {found.energies.seeds} seeds"

    evidence: list[str] = []
    holds = True
    for case in CONDITIONS:
        name = earlier_input(case)
        network = result.experiment[case, name]
        polynomial = result.experiment[case, COMPARED_TERMS]
        holds = holds and polynomial.energies.count >= network.energies.count
        evidence.append(
            f"{_name(case)}: within {polynomial.level * 1e3:.2g} mm come {arrived(polynomial)} "
            f"with six terms, {arrived(network)} with the {network.fronts[0].profile.size} "
            f"parameters of the {name}"
        )
    return Verdict("Six parameters leave as little vibration as sixteen.", holds, evidence)


def _beats_what_is_printed(result: Reproduction) -> Verdict:
    beaten, beats = True, list[str]()
    for found in result.rows:
        row, gradient = found.row, found.in_box.energy
        if row.earlier_energy is None:
            continue
        reference, _ = EARLIER[row.condition.task.plant.name]
        beaten = beaten and row.energy < row.earlier_energy
        beats.append(
            f"{_name(row.condition)}: printed {row.energy:.3g} J against {row.earlier_energy:.3g} "
            f"J of ref. [{reference}]; the gradient needs {gradient:.4g} J in the same box"
        )
    return Verdict("The proposed method beats refs [23] and [24], as printed.", beaten, beats)


def _beats_like_for_like(result: Reproduction) -> Verdict:
    evidence, beaten = list[str](), True
    for case in CONDITIONS:
        name = earlier_input(case)
        earlier, polynomial = result.experiment[case, name], result.experiment[case, COMPARED_TERMS]
        beaten = beaten and polynomial.energies.median < earlier.energies.median
        evidence.append(
            f"{_name(case)}, {own_search(case).label}: {_searched(polynomial)} with six terms, "
            f"{_searched(earlier)} with the {name}"
        )
    claim = "The same search finds less energy with six terms than with the networks of [23], [24]."
    return Verdict(claim, beaten, evidence)


def _networks_cost_more(result: Reproduction) -> Verdict:
    evidence, dearer = list[str](), True
    for case in STUDIED:
        name = earlier_input(case)
        # the fastest seed: others may have shared their core
        network, polynomial = (
            min(front.seconds for front in result.experiment[case, which].fronts)
            for which in (name, COMPARED_TERMS)
        )
        dearer = dearer and network > (1 + _DEARER) * polynomial
        evidence.append(
            f"{_name(case)}, {own_search(case).label}: {network:.2f} s for the fastest seed with "
            f"the {name}, {polynomial:.2f} s with six terms"
        )
    return Verdict("Networks cost more to compute.", dearer, evidence)


def _tuned(result: Reproduction) -> Verdict:
    above, tuned = 0.0, list[str]()
    for found in result.rows:
        row = found.row
        if row.earlier_energy is None:
            continue
        share = row.energy / found.in_box.energy - 1
        above = max(above, share)
        tuned.append(
            f"{_name(row.condition)}: the printed {row.energy:.3g} J is {share:.1%} above what the "
            "gradient needs in the same box, at rest on arrival"
        )
    claim = "The tuned coefficients are optimal in their search space (implied)."
    return Verdict(claim, above <= _GAIN, tuned)
