"""What `quietarm reproduce` shows and writes: tables, systems, the floor, claims, figures."""

from __future__ import annotations

from functools import partial

from quietarm.studies.display.words import title_of
from quietarm.studies.document.blocks import (
    Block,
    Bullets,
    Document,
    Picture,
    Section,
    Text,
)
from quietarm.studies.document.prose import told
from quietarm.studies.paper import ARM_HALF, SINGLE_LINK_SIXTH
from quietarm.studies.reproduction.claims import claims
from quietarm.studies.reproduction.paper_tables import (
    COEFFICIENT_TABLES,
    TITLES,
    coefficients_table,
    like_for_like,
    paper_table,
)
from quietarm.studies.reproduction.pictures import (
    against_earlier,
    floor_dots,
    redrawn,
    systems_figure,
)
from quietarm.studies.reproduction.recompute import Reproduction
from quietarm.studies.reproduction.systems import FREQUENCY_ERROR, Systems
from quietarm.studies.reproduction.tables import (
    all_systems,
    checks_table,
    finding,
    floor_table,
    of_plants,
    remarks,
    systems_table,
)

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
    by_number = {number: paper_table(result, number) for number in TITLES}
    for number in COEFFICIENT_TABLES:
        by_number[number] = coefficients_table(result, number)
    by_number = dict(sorted(by_number.items()))
    # a row of coefficients stays a row
    shown = [one.turned() if n in COEFFICIENT_TABLES else one for n, one in by_number.items()]
    experiment = like_for_like(result)
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
            *shown,
            *of_plants(experiment),
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
            Section("What the paper claims", [*claims(result), *_one_seed(result)]),
            Section("Figures", figures, screen=False),
        ],
        {
            **{f"table_{number}": table for number, table in by_number.items()},
            "like_for_like": experiment,
            "systems": all_systems(result.systems),
            "floor": floor,
        },
    )


def _one_seed(result: Reproduction) -> list[Block]:
    seeds = max(len(found.fronts) for found in result.experiment.values())
    words = "Each search stands here by one seed alone; --seeds 9 gives medians and quartiles."
    return [Text(words, soft=True)] if seeds == 1 else []


def systems_blocks(systems: Systems) -> list[Block]:
    """A picture, a table for each move with remarks below it, and how to read them."""
    blocks: list[Block] = [Picture("systems.png", partial(systems_figure, systems), "Side by side")]
    for case, every in systems.items():
        blocks += [systems_table(case, every), Bullets(remarks(every), soft=True)]
    return [*blocks, Text(_SYSTEMS, soft=True)]
