"""The paper's claims: their verdicts, and what would turn them round."""

import dataclasses

import pytest
from quietarm.studies.paper.printed import (
    ARM_HALF,
    ARM_WHOLE,
    SINGLE_LINK_SIXTH,
)
from quietarm.studies.reproduction.claims import claims


def costing(plan, **figures):
    """The same plan with other figures."""
    return dataclasses.replace(plan, motion=dataclasses.replace(plan.motion, **figures))


# Claims

TWO, MORE, ABOVE_SIX, BEATS, TUNED = range(5)


def with_more_terms(reproduction, changes):
    return dataclasses.replace(reproduction, more_terms={**reproduction.more_terms, **changes})


def with_rows(reproduction, change):
    return dataclasses.replace(reproduction, rows=tuple(map(change, reproduction.rows)))


def test_the_papers_claims_in_its_order_with_their_verdicts(reproduction):
    verdicts = claims(reproduction)
    assert [claim.text.split()[:2] for claim in verdicts] == [
        ["Two", "terms"],
        ["More", "terms"],
        ["The", "energy"],
        ["The", "proposed"],
        ["The", "tuned"],
    ]
    # docs/physics.md, 'The published optima are not optimal', and N = 6 is not the end.
    supported, refuted = "supported", "refuted"
    assert [claim.verdict for claim in verdicts] == [
        supported, supported, refuted, supported, refuted
    ]  # fmt: skip
    assert [claim.holds for claim in verdicts] == [c.verdict == supported for c in verdicts]


def test_more_terms_are_judged_by_the_mended_coefficients(reproduction):
    def dearer(result):
        mended = result.mended and costing(result.mended, energy=0.1777)
        return dataclasses.replace(result, mended=mended)

    verdict = claims(with_rows(reproduction, dearer))[MORE]
    assert verdict.verdict == "refuted"
    assert any("0.1777" in line for line in verdict.evidence)


def level_above_six(reproduction, gains):
    """N = 8 and 10 at the energy of N = 6, less a gain for some of them."""
    return with_more_terms(
        reproduction,
        {
            key: costing(
                plan,
                energy=(1 - gains.get(key, 0.0))
                * reproduction.more_terms[key[0], 6, key[2]].energy,
            )
            for key, plan in reproduction.more_terms.items()
            if key[1] > 6
        },
    )


def test_no_gain_above_six_is_supported_when_there_is_none(reproduction):
    verdict = claims(level_above_six(reproduction, {}))[ABOVE_SIX]
    assert verdict.verdict == "supported"
    assert all("0.0% less at N = 8, 0.0% less at N = 10" in line for line in verdict.evidence)


@pytest.mark.parametrize("condition", [SINGLE_LINK_SIXTH, ARM_HALF], ids=lambda value: value.label)
@pytest.mark.parametrize("terms", [8, 10])
@pytest.mark.parametrize("boxed", [True, False])
def test_one_gain_above_six_refutes_that_there_is_none(reproduction, condition, terms, boxed):
    doctored = level_above_six(reproduction, {(condition, terms, boxed): 0.05})
    verdict = claims(doctored)[ABOVE_SIX]
    assert verdict.verdict == "refuted"
    assert any(f"5.0% less at N = {terms}" in line for line in verdict.evidence)


def test_the_method_beats_the_earlier_studies_only_while_each_row_does(reproduction):
    def beaten(row):
        if (row.table, row.condition) != (6, ARM_WHOLE):
            return row
        return dataclasses.replace(row, earlier_energy=0.111)

    doctored = with_rows(
        reproduction, lambda result: dataclasses.replace(result, row=beaten(result.row))
    )
    verdict = claims(doctored)[BEATS]
    assert verdict.verdict == "refuted"
    assert any("0.111 J of ref. [24]" in line for line in verdict.evidence)
