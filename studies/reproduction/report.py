"""What `quietarm reproduce` shows and writes: tables, systems, the floor, claims, figures."""

from __future__ import annotations

from functools import partial

from quietarm.studies.display.words import title_of
from quietarm.studies.paper.printed import ARM_HALF, SINGLE_LINK_SIXTH
from quietarm.studies.report.document import Block, Bullets, Document, Picture, Section, Text
from quietarm.studies.reproduction.claims import claims
from quietarm.studies.reproduction.pictures import (
    against_earlier,
    floor_dots,
    redrawn,
    systems_figure,
)
from quietarm.studies.reproduction.recompute import Reproduction
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

_ERROR = f"{100 * FREQUENCY_ERROR:g} %"
_TABLES = (
    "Printed: as in the paper; printed coefficients: the same recomputed here. Gradient: the least "
    "energy at rest on arrival, within the paper's bound on the coefficients or without one; "
    "arriving at rest may cost a little more than the paper's small residual does. VEPSO, NSGA-II: "
    "the cheapest point of a front found with the paper's settings whose residual is no larger "
    "than that of the paper's own coefficients (where none are printed, of its N = 6 row for the "
    "same plant). Energies F2 and residuals F1 (at the tip) of coefficients and gradient are by "
    "CVODES. Network, Gaussians: what refs [23] and [24] move the joint with, as this project "
    "reads these references, with 16 parameters; the least energy at rest on arrival, in this "
    "project's box. They are no recomputation of the references' own figures, whose parameters are "
    "not published."
)
_SYSTEMS = (
    "Size: how many numbers are chosen. Residual, energy and peaks are by CVODES. "
    f"{_ERROR} off: the residual with all natural frequencies {_ERROR} lower or higher than "
    "assumed, the larger of the two, the joint moving as planned. Accel.: of the joint. Time: of "
    "one solve with its starts, or of one search, here; with the plain cycloid and the shapers "
    "nothing is looked for. ZV, ZVD, EI: input shapers for the plant's modes; their cycloid is "
    "shorter, so that the whole takes the duration. Paper: its coefficients for N = 6, a misprint "
    "mended; where it prints none, its printed energy. Network, Gaussians: what refs [23] and [24] "
    "move the joint with, as this project reads them; these and the spline by the gradient, at "
    "rest on arrival, weights up to 0.5. VEPSO, NSGA-II: the paper's polynomial, box and settings; "
    "the cheapest point that leaves no more than the paper's own coefficients for the plant, with "
    "two links no more than 1 mm. Boxed gradient: the same polynomial in the same box, at rest on "
    "arrival; gradient: without the box. Robust plan: the same, within 5 % of the plain cycloid's "
    f"residual whatever the frequencies within {_ERROR}. Floor: any joint motion; it starts and "
    "stops with jolts. The move of two links is not of this paper, and its box is this project's."
)
_FLOOR = (
    "Floor: the least energy over all joint motions that start and end at rest, joint and "
    "structure, without limits; it starts and stops with jolts. Left: an estimate of what finer "
    "grids would still lower it. Starts that agree: how many of the solver's starts end within "
    "0.5 % of the best. The paper's energies are the printed ones, with the paper's residual; "
    "VEPSO and NSGA-II are judged at that residual, the gradient and the floor at rest."
)
_CHECKS = (
    "Both ends and five points between them of the front by sequential quadratic programs, solved "
    "again by IPOPT from the plain cycloid: by which share the energies differ at most."
)
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
