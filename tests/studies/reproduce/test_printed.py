"""What `studies.paper` says against the paper's tables, typed here afresh from its text.

Powers of ten stand as the paper prints them, so that this file can be read beside it.
"""

import math

import pytest
from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.studies.reproduce.paper import COEFFICIENTS, MENDED, ROWS

PI = math.pi

TABLE_1 = {  # single link, thE = pi/6 rad, TE = 0.8 s
    2: ["3.347e-3", "-1.697e-1"],
    4: ["-1.690e-3", "-1.367e-1", "-1.951e-2", "-1.971e-1"],
    6: ["-1.889e-3", "-1.427e-1", "-4.247e-2", "-1.187e-1", "4.800e-2", "-1.890e-1"],
}
TABLE_2 = {2: "6.29e-2", 4: "5.26e-2", 6: "5.15e-2"}  # the same condition; N: F2 [J]
TABLE_3 = [  # single link, thS = 0, N = 6: thE [rad], TE [s], ref. [23], present [J]
    (PI / 6, 0.8, "6.30e-2", "5.15e-2"),
    (PI / 2, 1.0, "4.21e-1", "2.96e-1"),
    (PI / 2, 1.1, "3.52e-1", "2.23e-1"),
]
TABLE_4 = {  # arm, thS = 0, thE = pi/2 rad, TE = 0.8 s
    2: ["-1.023e-1", "-4.365e-1"],
    4: ["-9.583e-2", "-3.350e-1", "2.090e-1", "-2.854e-1"],
    6: ["-9.346e-2", "-3.488e-1", "1.989e-1", "-1.515e-1", "-2.993e-1", "-2.377e-1"],
}
TABLE_5 = {2: "2.09e-1", 4: "1.65e-1", 6: "1.49e-1"}  # the same condition; N: F2 [J]
TABLE_6 = [  # arm, N = 6: thS, thE [rad], TE [s], ref. [24], present [J]
    (0.0, PI / 2, 0.8, "2.00e-1", "1.49e-1"),
    (-PI / 2, PI / 4, 1.0, "1.55e-1", "1.43e-1"),
    (-PI / 2, PI / 2, 1.2, "2.22e-1", "2.00e-1"),
]
SIXTH = (SingleLinkManipulator(), 0.0, PI / 6, 0.8)
HALF = (ArmOnFlexibleLink(), 0.0, PI / 2, 0.8)


def described(condition):
    return (condition.task.plant, *condition.task.move)


def printed(number):
    """Rows of a table as (plant, start, target, duration, terms, energy, earlier energy)."""
    return [
        (*described(row.condition), row.terms, row.energy, row.earlier_energy)
        for row in ROWS
        if row.table == number
    ]


@pytest.mark.parametrize(("number", "table", "move"), [(2, TABLE_2, SIXTH), (5, TABLE_5, HALF)])
def test_energies_by_number_of_terms(number, table, move):
    typed = [(*move, terms, float(energy), None) for terms, energy in table.items()]
    assert printed(number) == typed


def test_energies_against_the_earlier_studies():
    link, arm = SingleLinkManipulator(), ArmOnFlexibleLink()
    assert printed(3) == [
        (link, 0.0, target, duration, 6, float(present), float(earlier))
        for target, duration, earlier, present in TABLE_3
    ]
    assert printed(6) == [
        (arm, start, target, duration, 6, float(present), float(earlier))
        for start, target, duration, earlier, present in TABLE_6
    ]


def test_coefficients_are_those_of_tables_1_and_4():
    typed = {
        (*move, terms): tuple(map(float, values))
        for move, table in ((SIXTH, TABLE_1), (HALF, TABLE_4))
        for terms, values in table.items()
    }
    assert {(*described(condition), n): a for (condition, n), a in COEFFICIENTS.items()} == typed


def test_one_exponent_is_mended_and_nothing_else():
    # docs/physics.md, 'Misprints': Table 4, N = 6: a_5 is -2.993e-2.
    ((condition, terms), mended), *others = MENDED.items()
    assert others == []
    assert (*described(condition), terms) == (*HALF, 6)
    as_printed = [float(value) for value in TABLE_4[6]]
    assert mended == (*as_printed[:4], -2.993e-2, as_printed[5])


def test_search_boxes_are_those_of_eqs_12_and_17():
    for row in ROWS:
        eq = 0.2 if isinstance(row.condition.task.plant, SingleLinkManipulator) else 0.5
        assert row.condition.bound == eq
