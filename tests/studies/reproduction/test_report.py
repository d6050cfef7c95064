"""The reproduction's report: its files, pictures and screen."""

import csv
import io

import pytest
from quietarm.ocp import evaluate_coefficients
from quietarm.studies.document.files import document_files
from quietarm.studies.paper import ARM_HALF, COEFFICIENTS, SINGLE_LINK_SIXTH
from quietarm.studies.reproduction.report import reproduction_document

# The report


@pytest.fixture(scope="module")
def report(reproduction, tmp_path_factory, coarsely):
    """The folder that `write` filled, and what it says it wrote."""
    folder = tmp_path_factory.mktemp("results")
    files = document_files(folder, reproduction_document(reproduction))
    with coarsely():
        for path, write in files:
            write(path)
    return folder, [path for path, _ in files]


def test_the_report_says_what_it_wrote_and_writes_nothing_else(report):
    folder, written = report
    assert sorted(written) == sorted(folder.iterdir())
    assert sorted(path.name for path in written) == [
        "figure_2.png", "figure_3.png", "figure_5.png", "figure_6.png",
        "floor.csv", "floor.png", "like_for_like.csv", "report.md", "systems.csv", "systems.png",
        "table_1.csv", "table_2.csv", "table_3.csv", "table_4.csv", "table_5.csv", "table_6.csv",
    ]  # fmt: skip


@pytest.mark.parametrize("number", [2, 3, 5, 6])
def test_csv_holds_the_figures_in_full(reproduction, report, number):
    rows = list(csv.DictReader(io.StringIO((report[0] / f"table_{number}.csv").read_text())))
    results = [result for result in reproduction.rows if result.row.table == number]
    plain = [row for row in rows if "mended" not in row["terms"]]
    for row, result in zip(plain, results, strict=True):
        assert (row["move"], row["terms"]) == (result.row.condition.label, str(result.row.terms))
        assert as_number(row["earlier_study_J"]) == result.row.earlier_energy
        assert as_number(row["printed_J"]) == result.row.energy
        printed = result.printed
        assert as_number(row["printed_coefficients_J"]) == (printed and printed.energy)
        for name, plan in (("in", result.in_box), ("no", result.free)):
            assert float(row[f"gradient_{name}_box_J"]) == plan.energy
            assert float(row[f"gradient_{name}_box_residual_mm"]) == plan.residual * 1e3


@pytest.mark.parametrize(("number", "case"), [(1, SINGLE_LINK_SIXTH), (4, ARM_HALF)])
def test_tables_1_and_4_have_coefficients_that_give_their_energies(report, number, case):
    rows = list(csv.DictReader(io.StringIO((report[0] / f"table_{number}.csv").read_text())))
    for terms in (2, 4, 6):
        of = {row["coefficients"]: row for row in rows if f"N = {terms}," in row["coefficients"]}
        printed = of[f"N = {terms}, printed"]
        coefficients = [float(printed[f"a_{n}"]) for n in range(1, terms + 1)]
        assert tuple(coefficients) == COEFFICIENTS[case, terms]
        for row in of.values():
            found = [float(row[f"a_{n}"]) for n in range(1, terms + 1)]
            plan = evaluate_coefficients(case.task, found)
            assert plan.energy == pytest.approx(float(row["energy_J"]), rel=1e-9)


def as_number(cell):
    """A figure of a CSV file; None where there is none."""
    return float(cell) if cell else None
