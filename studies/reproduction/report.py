"""What `quietarm reproduce` shows and writes: tables, systems, the floor, claims, figures."""

from __future__ import annotations

from functools import partial
from itertools import pairwise

from quietarm.ocp import Plan
from quietarm.studies.display.words import title_of
from quietarm.studies.document.blocks import (
    Block,
    Bullets,
    Document,
    Picture,
    Section,
    Text,
    Verdict,
)
from quietarm.studies.document.prose import told
from quietarm.studies.paper import ARM_HALF, EARLIER, SINGLE_LINK_SIXTH, Case
from quietarm.studies.reproduction.pictures import (
    against_earlier,
    floor_dots,
    redrawn,
    systems_figure,
)
from quietarm.studies.reproduction.recompute import BEYOND_SIX, STUDIED, Reproduction
from quietarm.studies.reproduction.systems import FREQUENCY_ERROR, Systems
from quietarm.studies.reproduction.tables import (
    TITLES,
    all_systems,
    checks_table,
    finding,
    floor_table,
    of_plants,
    paper_table,
    systems_table,
)

_AT_REST = 1e-7
"""A residual below this [m] counts as cancelled."""
_GAIN = 0.01
"""A fall of the energy by more than this share counts as a gain."""


def claims(result: Reproduction) -> list[Verdict]:
    """Judge the paper's claims by the recomputed figures."""
    return [
        _two_terms_suffice(result),
        _more_terms_lower_the_energy(result),
        _no_gain_above_six(result),
        *_against_the_earlier_studies(result),
    ]


def _name(condition: Case) -> str:
    return f"{condition.task.plant.name} {condition.label}"


def _printed(result: Reproduction, condition: Case, terms: int) -> Plan:
    plan = result.result(condition, terms).mended_or_printed
    assert plan is not None  # of the conditions studied the paper prints all
    return plan


def _two_terms_suffice(result: Reproduction) -> Verdict:
    gradient = {case: result.more_terms[case, 2, True].residual for case in STUDIED}
    return Verdict(
        "Two terms suffice to cancel the residual vibration.",
        max(gradient.values()) < _AT_REST,
        [
            f"{_name(case)}: {result.cycloids[case].residual * 1e3:.2f} mm with the plain cycloid, "
            f"{_printed(result, case, 2).residual * 1e3:.2f} mm with the two printed coefficients, "
            f"{left * 1e3:.1e} mm with the gradient's two"
            for case, left in gradient.items()
        ],
    )


def _more_terms_lower_the_energy(result: Reproduction) -> Verdict:
    energies: dict[str, list[float]] = {}
    for case in STUDIED:
        printed = [_printed(result, case, n).energy for n in (2, 4, 6)]
        gradient = [result.more_terms[case, n, True].energy for n in (2, 4, 6)]
        energies[f"{_name(case)}, printed coefficients"] = printed
        energies[f"{_name(case)}, gradient in the box"] = gradient
    return Verdict(
        "More terms lower the energy.",
        all(more < fewer for each in energies.values() for fewer, more in pairwise(each)),
        [
            f"{name}, N = 2, 4, 6: {', '.join(f'{energy:.4f}' for energy in each)} J"
            for name, each in energies.items()
        ],
    )


def _no_gain_above_six(result: Reproduction) -> Verdict:
    evidence: list[str] = []
    holds = True
    for case in STUDIED:
        for boxed, name in ((True, "in the paper's box"), (False, "without a box")):
            six, *beyond = (result.more_terms[case, n, boxed].energy for n in (6, *BEYOND_SIX))
            gains = {n: 1 - energy / six for n, energy in zip(BEYOND_SIX, beyond, strict=True)}
            holds = holds and max(gains.values()) <= _GAIN
            evidence.append(
                f"{_name(case)}, gradient {name}: {six:.4f} J at N = 6; "
                + ", ".join(f"{gain:.1%} less at N = {n}" for n, gain in gains.items())
            )
    return Verdict("The energy does not fall further above six terms.", holds, evidence)


def _against_the_earlier_studies(result: Reproduction) -> list[Verdict]:
    """Whether the paper's energies are below the earlier studies', and near the gradient's."""
    beaten, above, beats, tuned = True, 0.0, list[str](), list[str]()
    for found in result.rows:
        row, gradient = found.row, found.in_box.energy
        if row.earlier_energy is None:
            continue
        name, share = _name(row.condition), row.energy / gradient - 1
        reference, _ = EARLIER[row.condition.task.plant.name]
        beaten, above = beaten and row.energy < row.earlier_energy, max(above, share)
        beats.append(
            f"{name}: printed {row.energy:.3g} J against {row.earlier_energy:.3g} J of ref. "
            f"[{reference}]; the gradient needs {gradient:.4g} J in the same box"
        )
        tuned.append(
            f"{name}: the printed {row.energy:.3g} J is {share:.1%} above what the gradient needs "
            "in the same box, at rest on arrival"
        )
    optimal = "The tuned coefficients are optimal in their search space (implied)."
    return [
        Verdict("The proposed method beats refs [23] and [24].", beaten, beats),
        Verdict(optimal, above <= _GAIN, tuned),
    ]


_TABLES, _SYSTEMS, _FLOOR, _CHECKS = told(
    "reproduction/reading.txt", error=f"{100 * FREQUENCY_ERROR:g} %"
)
"""How to read the paper's tables, those of systems, the floor's and that of both solvers."""
_FIGURES = (
    (2, redrawn, SINGLE_LINK_SIXTH),
    (3, against_earlier, SINGLE_LINK_SIXTH),
    (5, redrawn, ARM_HALF),
    (6, against_earlier, ARM_HALF),
)


def reproduction_document(result: Reproduction) -> Document:
    """The paper's tables and figures, all systems side by side, the floor, both solvers, claims."""
    paper = {f"table_{number}": paper_table(result, number) for number in TITLES}
    floor = floor_table(result)
    figures = [
        Picture(
            f"figure_{number}.png",
            partial(draw, result, case, f"Fig. {number} redrawn: {title_of(case.task)}"),
            f"Fig. {number}",
        )
        for number, draw, case in _FIGURES
    ]
    return Document(
        "The paper, recomputed",
        [
            *paper.values(),
            Text(_TABLES, soft=True),
            Section("Side by side", systems_blocks(result.systems)),
            Section(
                "How far from the floor",
                [
                    Text(finding(result)),
                    *of_plants(floor),
                    Text(_FLOOR, soft=True),
                    Picture("floor.png", partial(floor_dots, result), "Multiples of the floor"),
                    checks_table(result),
                    Text(_CHECKS, soft=True),
                ],
            ),
            Section("What the paper claims", claims(result)),
            Section("Figures", figures, screen=False),
        ],
        {**paper, "systems": all_systems(result.systems), "floor": floor},
    )


def systems_blocks(systems: Systems) -> list[Block]:
    """A picture, a table for each move, what is missing below it, and how to read them."""
    blocks: list[Block] = [Picture("systems.png", partial(systems_figure, systems), "Side by side")]
    for case, every in systems.items():
        missing = [f"{found.name}: {found.why}" for found in every if found.why]
        blocks += [systems_table(case, every), Bullets(missing, soft=True)]
    return [*blocks, Text(_SYSTEMS, soft=True)]
