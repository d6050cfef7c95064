"""Help, versions and usage: what a newcomer types first."""

import pytest
from quietarm.models import __version__
from quietarm.studies.cli.application import COMMANDS


@pytest.mark.parametrize("line", ["--help", "-h", *(f"{name} --help" for name in COMMANDS)])
def test_every_command_has_help(call, line):
    code, out, err = call(line)
    assert (code, err) == (0, "")
    if line not in ("--help", "-h"):
        assert "Examples" in out


def test_the_version(call):
    assert call("--version") == (0, f"quietarm, version {__version__}\n", "")


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("plam", ["plam", "did you mean 'plan'"]),
        ("plan", ["--target"]),
        ("plan singlelink --target 1 --duration 1", ["singlelink", "single-link"]),
        ("plan single-link --target 30deg --duration", ["--duration"]),
        ("plan single-link --target 30deg --duration 0.8 --targt 1", ["--targt", "--target"]),
        ("plan single-link --target much --duration 1", ["--target", "much", "30deg"]),
        ("plan single-link --target 30 --duration 0.8", ["30", "degrees"]),
        ("plan single-link --target 30deg --duration -1", ["duration is -1 s"]),
        ("plan single-link --target 30deg --duration 1 --starts 2.5", ["--starts", "2.5"]),
        ("plan single-link --target 30deg --duration 1 --set omga=3", ["omga", "omega"]),
        ("plan single-link --target 30deg --duration 1 --csv no/where.csv", ["--csv", "no"]),
        ("plan single-link --target 30deg --duration 1 --figure a.txt", ["a.txt", ".png"]),
        ("plan single-link --target 30deg --duration 1 --output a --csv a", ["--output", "--csv"]),
        ("front single-link --target 30deg --duration 1 --method nsga2", ["bound"]),
        ("front single-link --target 30deg --duration 1 --method nsgga2", ["nsgga2", "nsga2"]),
        ("front single-link --target 30deg --duration 1 --method epsilon --population 9",
         ["--population", "metaheuristic"]),
        ("compare a.json b.json", ["a.json", "no such file"]),
        ("robustness", ["no plan is given"]),
        ("contest --output c --methods nsga9", ["nsga9"]),
        ("study --runs 0", ["runs is 0"]),
    ],
)  # fmt: skip
def test_what_is_wrong_is_one_line_with_the_remedy(refused, line, words):
    said = refused(line)
    assert [word for word in words if word not in said] == []
