"""The package's copy of the paper's tables against the tables, typed here afresh from its text.

Powers of ten stand as the paper prints them, so that this file can be read beside it.
"""

from math import pi

from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.studies.reproduce.paper import COEFFICIENTS, MENDED, ROWS

PLANTS = {"link": SingleLinkManipulator(), "arm": ArmOnFlexibleLink()}
# table, plant, thS and thE in units of pi, TE [s], N, F2 of the earlier study and of the paper [J]
PRINTED = """
2 link  0   1/6 0.8 2 -       6.29e-2
2 link  0   1/6 0.8 4 -       5.26e-2
2 link  0   1/6 0.8 6 -       5.15e-2
3 link  0   1/6 0.8 6 6.30e-2 5.15e-2
3 link  0   1/2 1.0 6 4.21e-1 2.96e-1
3 link  0   1/2 1.1 6 3.52e-1 2.23e-1
5 arm   0   1/2 0.8 2 -       2.09e-1
5 arm   0   1/2 0.8 4 -       1.65e-1
5 arm   0   1/2 0.8 6 -       1.49e-1
6 arm   0   1/2 0.8 6 2.00e-1 1.49e-1
6 arm  -1/2 1/4 1.0 6 1.55e-1 1.43e-1
6 arm  -1/2 1/2 1.2 6 2.22e-1 2.00e-1
"""
TABLE_1 = {  # single link, thE = pi/6 rad, TE = 0.8 s
    2: "3.347e-3 -1.697e-1",
    4: "-1.690e-3 -1.367e-1 -1.951e-2 -1.971e-1",
    6: "-1.889e-3 -1.427e-1 -4.247e-2 -1.187e-1 4.800e-2 -1.890e-1",
}
TABLE_4 = {  # arm, thS = 0, thE = pi/2 rad, TE = 0.8 s
    2: "-1.023e-1 -4.365e-1",
    4: "-9.583e-2 -3.350e-1 2.090e-1 -2.854e-1",
    6: "-9.346e-2 -3.488e-1 1.989e-1 -1.515e-1 -2.993e-1 -2.377e-1",
}
SIXTH, HALF = (PLANTS["link"], 0.0, pi / 6, 0.8), (PLANTS["arm"], 0.0, pi / 2, 0.8)


def described(condition):
    return (condition.task.plant, *condition.task.move)


def of_pi(text):
    above, _, below = text.partition("/")
    return int(above) * pi / int(below or 1)


def test_energies_are_those_of_tables_2_3_5_and_6():
    typed = []
    for line in PRINTED.split("\n")[1:-1]:
        table, plant, start, target, duration, terms, earlier, paper = line.split()
        move = (PLANTS[plant], of_pi(start), of_pi(target), float(duration))
        earlier = None if earlier == "-" else float(earlier)
        typed.append((int(table), move, int(terms), float(paper), earlier))
    assert typed == [
        (row.table, described(row.condition), row.terms, row.energy, row.earlier_energy)
        for row in ROWS
    ]


def test_coefficients_are_those_of_tables_1_and_4_and_one_exponent_is_corrected():
    typed = {
        (*move, terms): tuple(map(float, values.split()))
        for move, table in ((SIXTH, TABLE_1), (HALF, TABLE_4))
        for terms, values in table.items()
    }
    assert {(*described(condition), n): a for (condition, n), a in COEFFICIENTS.items()} == typed
    # docs/physics.md, 'Misprints': Table 4, N = 6: a_5 is -2.993e-2
    ((condition, terms), mended), *others = MENDED.items()
    assert others == []
    assert (*described(condition), terms) == (*HALF, 6)
    assert mended == (*typed[*HALF, 6][:4], -2.993e-2, typed[*HALF, 6][5])


def test_search_boxes_are_those_of_eqs_12_and_17():
    for row in ROWS:
        assert row.condition.bound == (0.2 if row.condition.task.plant == PLANTS["link"] else 0.5)
