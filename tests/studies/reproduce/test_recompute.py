"""The paper recomputed: the gradient's answers, systems side by side, claims, the report."""

from dataclasses import replace
from math import isnan, nan

import pytest

from quietarm.ocp import FrontPoint, ModalState
from quietarm.studies.reproduce.claims import claims
from quietarm.studies.reproduce.paper import (
    COEFFICIENTS,
    CONDITIONS,
    ROWS,
    SINGLE_LINK_SIXTH,
    STUDIED,
    condition_of,
    paper_points,
)
from quietarm.studies.reproduce.paper_report import TITLES, reproduction_report
from quietarm.studies.reproduce.recompute import Effort, Reproduction, recompute_paper
from quietarm.studies.reproduce.searched import OLD_CONSTANTS

pytestmark = pytest.mark.slow

SHORT = Effort(
    full=True,
    searches={
        "vepso": {"population": 20, "generations": 8},
        "nsga2-paper": {"population": 20, "generations": 3},
    },
    starts=1,
    points=3,
    systems=STUDIED,
    free_motion={"starts": 1, "energy_tolerance": 0.05},
)
ROUNDED = 1 + 1e-6
"""Room for two solves of one problem to end at the same optimum."""


@pytest.fixture(scope="module")
def reproduction():
    """The paper recomputed; how well searches find is tested where they are."""
    return recompute_paper(SHORT)


@pytest.mark.parametrize("case", CONDITIONS, ids=lambda case: case.name)
def test_the_gradient_reaches_the_energies_asked_for_at_rest(reproduction, case):
    # nothing is below the best free motion, and ten terms are near it (docs/physics.md)
    floor = reproduction.floor(case).energy
    assert 1 < reproduction.free(case, 10).energy / floor < 1.3
    # docs/accuracy.md: 7e-7, but for a point that lies 1.1e-5 above what IPOPT finds
    assert reproduction.check(case).largest < 1e-4


def test_a_task_is_a_condition_within_rounding_and_at_rest_alone():
    task = SINGLE_LINK_SIXTH.task
    assert condition_of(replace(task, target=task.target * (1 + 1e-15))) is SINGLE_LINK_SIXTH
    ringing = replace(task, initial=ModalState((0.005,), (0.0,)))
    assert condition_of(ringing) is None
    assert paper_points(ringing, {2, 4, 6}) == []
    assert [point.label for point in paper_points(task, {2, 6})] == [
        "the paper's best (2 terms)",
        "the paper's best (6 terms)",
    ]


def test_every_system_stands_on_every_condition_with_its_worst_case(reproduction):
    for case, systems in reproduction.systems.items():
        found = {one.name: one for one in systems}
        assert list(found)[:5] == ["cycloid", "zv", "zvd", "ei", "paper"]
        assert list(found)[-4:] == [
            "gradient, within the bounds",
            "gradient",
            "robust plan",
            "free motion",
        ]
        cycloid = found["cycloid"]
        there = [
            reproduction.cycloid(case).candidate.perturbed({"frequency": error}).residual
            for error in (-0.1, 0.1)
        ]
        assert cycloid.worst.residual >= max(there) * ROUNDED**-1
        if found["robust plan"].motion:
            assert found["robust plan"].worst.residual < 0.055 * cycloid.motion.residual
        assert bool(found["paper"].why) == ((case, 6) not in COEFFICIENTS)


def test_after_an_interruption_the_fronts_that_are_there_are_kept(tmp_path):
    effort = replace(SHORT, full=False)
    told = list[str]()

    def interrupt(name):
        told.append(name)
        if len(told) == 2 or name.startswith("gradient"):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        recompute_paper(effort, 1, interrupt, tmp_path)
    kept = {path.name: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    assert len(kept) in (2, 3)  # the third may be done before the second is told
    with pytest.raises(KeyboardInterrupt):
        recompute_paper(effort, 1, interrupt, tmp_path)
    after = {path.name: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    assert len(after) == len(effort.searched)
    assert {name: after[name] for name in kept} == kept


# Claims


def verdict_on(words, reproduction):
    (found,) = [verdict for verdict in claims(reproduction) if words in verdict.claim]
    return found


def test_the_claims_of_printed_coefficients_and_gradient_have_their_verdicts(reproduction):
    # docs/physics.md, 'The published optima are not optimal', and N = 6 is not the end; the
    # others can be read off Figs 2 and 5, which the printed coefficients give.
    for words in ("Two terms suffice", "none (Fig. 2d)", "(Fig. 2c)", "More terms lower the energy",
                  "(5c)", "(Fig. 5d)", "as printed"):  # fmt: skip
        assert verdict_on(words, reproduction).holds, words
    for words in ("further above six", "optimal in their search space"):
        assert not verdict_on(words, reproduction).holds, words
    assert not any(verdict.evidence.empty for verdict in claims(reproduction))


def test_claims_need_full_effort(reproduction):
    with pytest.raises(ValueError, match=r"Effort\(full=True\)"):
        claims(replace(reproduction, effort=Effort()))


def with_energies(reproduction: Reproduction, changes) -> Reproduction:
    """Other energies of the seeds of the paper's searches; NaN where one does not come near."""
    searched = dict(reproduction.searched)
    for key, energies in changes.items():
        found = searched[key]
        coefficients = found.fronts[0].profile.plain
        points = [
            FrontPoint(coefficients, 2 * found.level, 1e-3) if isnan(energy)
            else FrontPoint(coefficients, found.level / 2, energy)
            for energy in energies
        ]  # fmt: skip
        fronts = tuple(replace(found.fronts[0], points=(point,)) for point in points)
        searched[key] = replace(found, fronts=fronts)
    return replace(reproduction, searched=searched)


@pytest.mark.parametrize(("network", "holds"), [(0.04, False), (0.06, True), (nan, True)])
def test_like_for_like_the_medians_of_the_same_search_decide(reproduction, network, holds):
    changes = {(case, 6): [0.05] * 3 for case in CONDITIONS}
    changes |= {(case, case.earlier[1]): [0.06, 0.06, nan] for case in CONDITIONS}
    case = CONDITIONS[0]
    changes[case, case.earlier[1]] = [0.01, network, 0.9]
    found = verdict_on("The same search", with_energies(reproduction, changes))
    assert found.holds is holds
    median = {0.04: "0.0400", 0.06: "0.0600"}.get(network, "0.9")
    assert f"network: {median}" in found.evidence["earlier input"][0]


def test_a_cell_that_hangs_on_its_seeds_does_not_hold(reproduction):
    # Table 3 prints 0.0515 J
    for energies, holds in (([0.049] * 5, True), ([0.049] * 4 + [0.052], False)):
        changed = with_energies(reproduction, {(SINGLE_LINK_SIXTH, 6): energies})
        key = SINGLE_LINK_SIXTH, OLD_CONSTANTS
        searched = changed.searched | {key: changed.searched[SINGLE_LINK_SIXTH, 6]}
        found = verdict_on("neither on seeds", replace(changed, searched=searched))
        assert found.holds is holds
    assert found.evidence["above the printed"].tolist() == [1, 0, 1]


# The report


@pytest.fixture(scope="module")
def report(reproduction):
    return reproduction_report(reproduction)


def test_the_report_says_within_what_time_residuals_are(report, reproduction):
    assert {case.task.residual_window for case in CONDITIONS} == {1.0}  # eq (11)
    assert "residuals are within 1 s after arrival" in report.markdown()


@pytest.mark.parametrize("number", TITLES)
def test_tables_hold_printed_and_recomputed_energies(report, reproduction, number):
    table = report.tables[f"table_{number}"]
    rows = [row for row in ROWS if row.table == number]
    assert table["paper, printed [J]"].tolist() == [row.energy for row in rows]
    assert table["gradient at rest, in the box [J]"].tolist() == [
        reproduction.in_box(row.condition, row.terms).energy for row in rows
    ]
    still = table["gradient at rest, in the box [J]"]
    within = table["  gradient within the same [J]"]
    assert (within <= ROUNDED * still).all()  # what may ring a little need not take more
    if rows[0].earlier_energy:
        assert table["  printed there [J]"].tolist() == [row.earlier_energy for row in rows]


def test_the_report_names_its_pictures_and_each_can_be_drawn(report):
    text = report.markdown()
    for name, draw in report.figures.items():
        assert f"![{name}]({name})" in text
        assert len(draw().axes) == 4
    assert report.tables["six"]["condition"].tolist() == [case.name for case in CONDITIONS]
    assert set(report.tables["claims"]["verdict"]) == {"holds", "does not hold"}
    assert "Does not hold" in text
