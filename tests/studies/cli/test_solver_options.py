"""An option of a solver is a field of its class: commands, sweeps, jobs and files have it then."""

from dataclasses import dataclass
from functools import partial
from typing import ClassVar, Literal

import pytest
from lines import MOVE

import quietarm as qa
from quietarm.metaheuristics import Job
from quietarm.ocp.checks import positive
from quietarm.ocp.solvers.choice import SOLVERS, other_solver, stand_in, stated_solver
from quietarm.ocp.solvers.solver import option
from quietarm.studies.cli.application import command_of
from quietarm.studies.cli.options import SOLVER, solver_options

COARSE = "single-link --duration 0.8 --terms 2 --target"
WITH_SOLVER = ("plan", "front", "sweep", "compare")


@dataclass(frozen=True)
class OwnSqp(qa.Sqp):
    """Quietarm's own solver, with two options that are made up here and nowhere else."""

    solved: ClassVar[set[tuple[float, str]]] = set()

    boldness: float = option(
        0.5, "How far a first step goes.", partial(positive, most=1), word="share"
    )
    second_order: Literal["exact", "estimated"] = option("exact", "What curvature is.")
    patient: bool = option(False, "Whether it waits.")
    cap: float | None = option(None, "The longest step; none by default.", positive, word="amount")

    def solve(self, *given, **settings):
        self.solved.add((self.boldness, self.second_order))
        return super().solve(*given, **settings)


@pytest.fixture
def made_up(monkeypatch):
    """The commands, had they been written with that solver; what it has solved with."""
    monkeypatch.setitem(SOLVERS, "sqp", OwnSqp)
    options = solver_options()
    usual = {param.name for param in SOLVER}
    for name in WITH_SOLVER:
        command = command_of(name)
        others = [param for param in command.params if param.name not in usual]
        monkeypatch.setattr(command, "params", [*others, *options])
    OwnSqp.solved.clear()
    return OwnSqp.solved


ASKED = "--boldness 25% --second-order estimated"


@pytest.mark.parametrize(
    "line",
    [
        f"plan {MOVE} --terms 2 --output plan.json",
        f"front {MOVE} --terms 2 --bound 0.3 --points 3 --output front.json",
        f"sweep {COARSE} 0.4,0.5 --output m.zarr",
    ],
)
def test_a_command_has_it_and_its_file_states_it(made_up, call, folder, line):
    assert call(f"{line} {ASKED} --quiet")[0] == 0
    assert made_up == {(0.25, "estimated")}
    for path in folder.glob("*.json"):
        kind = qa.Plan if path.stem == "plan" else qa.Front
        settings = kind.load(path).record.settings
        assert settings["solver_boldness"] == 0.25
        assert stated_solver(settings) == OwnSqp(boldness=0.25, second_order="estimated")


def test_a_value_that_is_none_is_said_with_the_article_of_its_word(made_up, call, folder):
    code, _, err = call(f"plan {MOVE} --cap wide")
    assert (code, "'wide' is not an amount; give" in err) == (2, True)
    _, _, err = call(f"plan {MOVE} --boldness wide")
    assert "'wide' is not a share; give" in err


def test_an_option_that_may_be_none_is_a_number_on_the_command_line(made_up, done, call):
    done(f"plan {MOVE} --terms 2 --cap 0.5 --patient --quiet --output plan.json")
    settings = qa.Plan.load("plan.json").record.settings
    assert (settings["solver_cap"], settings["solver_patient"]) == (0.5, True)
    code, _, err = call(f"plan {MOVE} --terms 2 --cap much --quiet")
    assert (code, err.count("\n")) == (2, 1)


def test_a_sweep_goes_on_with_the_same_options_alone(made_up, call, folder):
    line = f"sweep {COARSE} 0.4,0.5 --output m.zarr --quiet"
    assert call(f"{line} {ASKED}")[0] == 0
    assert call(f"{line} --second-order estimated --boldness 0.25")[0] == 0
    code, _, err = call(f"{line} --second-order estimated")
    assert code == 2
    assert "m.zarr is of another sweep: it differs in solver_boldness" in err


@pytest.mark.usefixtures("made_up")
def test_a_dataset_of_a_solver_with_fewer_options_is_one_of_their_defaults(call, folder):
    """As one of 2.0.0 is, which knows nothing of them."""
    line = f"sweep {COARSE} 0.4,0.5 --output m.zarr --quiet"
    with pytest.MonkeyPatch.context() as before:
        before.setitem(SOLVERS, "sqp", qa.Sqp)
        assert call(line)[0] == 0
    assert call(line)[0] == 0


def test_a_job_has_it_by_its_name_in_records(made_up):
    job = Job("single-link-30deg-0.8s-2-terms", "epsilon",
              settings={"points": 3, "solver_boldness": 0.75})  # fmt: skip
    assert job.run().record.settings["solver_boldness"] == 0.75
    assert {boldness for boldness, _ in made_up} == {0.75}
    with pytest.raises(ValueError, match=r"boldness of the solver is 2; give at most 1"):
        Job(job.problem, "epsilon", settings={"solver_boldness": 2})
    for name, wrong, words in (
        ("second_order", "guessed", "is 'guessed'; give exact or estimated"),
        ("patient", "no", "is 'no'; give True or False"),
        ("cap", -1, "is -1; give a positive number"),
    ):
        with pytest.raises(ValueError, match=words):
            Job(job.problem, "epsilon", settings={f"solver_{name}": wrong})
    with pytest.raises(ValueError, match="has no setting 'solver_boldness'"):
        Job(job.problem, "epsilon:ipopt", settings={"solver_boldness": 0.75})


@pytest.mark.usefixtures("made_up")
@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ("--boldness 2", "boldness of the solver is 2; give at most 1"),
        ("--boldness much", "Invalid value for '--boldness': 'much' is not a share"),
        ("--second-order none", "unknown second order 'none' (known: exact, estimated)"),
        (
            "--boldness 25% --solver ipopt",
            "--boldness is an option of sqp, and the solver is ipopt; leave it out",
        ),
    ],
)
def test_what_is_no_value_of_it_is_refused(refused, asked, told):
    assert told in refused(f"plan {MOVE} {asked}")


@pytest.mark.usefixtures("made_up")
def test_help_says_what_it_is_whose_it_is_and_its_default(call):
    _, out, _ = call("plan --help")
    words = " ".join(out.split())
    assert "--boldness SHARE Of sqp: How far a first step goes. [default: 0.5]" in words
    assert "--second-order [exact|estimated]" in words


def test_what_stands_in_has_what_both_have():
    own = OwnSqp(tolerance=1e-7, log=True, boldness=0.25)
    assert stand_in(own) == qa.Ipopt(tolerance=1e-7, log=True)
    assert other_solver(stand_in(own)) == qa.Sqp(tolerance=1e-7, log=True)


def test_a_record_with_an_option_that_no_solver_has_is_refused():
    with pytest.raises(ValueError, match="sqp has no setting 'solver_haste'"):
        stated_solver({"solver": "sqp", "solver_haste": 3})


@pytest.mark.slow
@pytest.mark.parametrize("typed", ["25%", "25 %", "0.25"])
@pytest.mark.usefixtures("made_up")
def test_a_setting_of_a_bench_is_a_share_in_per_cent_as_well(done, folder, typed):
    done(
        "bench single-link-30deg-0.8s-2-terms --methods Epsilon:SQP --runs 1 --quiet "
        f"--setting epsilon:sqp.points=3 --setting 'epsilon.solver_boldness={typed}' --output b"
    )
    (run,) = folder.glob("b/*/epsilon(*)/seed0.json")
    assert qa.Front.load(run).record.settings["solver_boldness"] == 0.25


@pytest.mark.usefixtures("made_up")
@pytest.mark.parametrize(
    ("name", "rows"),
    [
        ("epsilon", ["points 50: points of the front", "solver_boldness 0.5: how far"]),
        ("EPSILON:sqp", ["solver_second_order exact: what curvature is"]),
        ("multistart:ipopt", ["starts 100: random starts", "solver_iterations 500: most"]),
        ("nsga2+polish", ["crossover 0.9: share", "solver_boldness 0.5: how far"]),
        ("memetic", ["gradient_every 10: generations", "solver_boldness 0.5: how far"]),
    ],
)
def test_the_settings_of_a_method_are_listed_with_its_solvers_options(done, name, rows):
    listed = " ".join(done(f"list {name}").split())
    assert all(row in listed for row in rows)


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("front single-link --method epsilon:ipopt", "give --method epsilon --solver ipopt"),
        ("search single-link --method nsga2+polish", "quietarm front --polish FILE"),
        ("list epsilon:hsl", "unknown solver 'hsl' (known: sqp, ipopt)"),
    ],
)
def test_a_method_that_belongs_elsewhere_says_where(refused, line, told):
    assert told in refused(line)
