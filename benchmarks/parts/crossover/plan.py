"""Plan of what is run, in which order: jobs of the bench, by axis and round.

A round is a seed. Within a round the centre comes first, then coefficients and budget crossed, then
the kinds of energy, then large budgets: any stop leaves every finished round balanced.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quietarm.metaheuristics import PRESETS, Job

from .limits import LIMITS
from .moves import Move
from .problems import CENTRE_FAMILY, CENTRE_TERMS, FAMILIES, INTEGERS, Case
from .tuned_cells import TUNED_CELLS, TunedCell

AXES = (
    "centre", "crossing", "limits", "few", "energy", "paper", "noise", "objectives", "large",
    "tuned", "million", "robust", "profiles", "integers",
)  # fmt: skip
TERMS = (2, 4, 6, 10, 16, 24)
BUDGETS = (1_000, 10_000)
FEW = 200
"""Candidates where each is a run on a machine, or an hour of a simulator."""
LARGE, MILLION = 100_000, 1_000_000
KINDS = ("copper", "stages", "motor-map", "integer")
SEEDS = {200: 15, 1_000: 15, 10_000: 15, 40_000: 7, 100_000: 7, 1_000_000: 3}
"""Rounds of the full plan, by budget."""
LADDER = (3, 5, 10, 50, 200)
"""Points of the gradient's fronts: more of them take more time, as a search's candidates do."""
LONGEST = LADDER[-1]
CROSSED = ("nsga2", "gde3", "moead-de", "mo-cma-es", "memetic", "slsqp")
"""Methods of candidates that are run in every cell of the map, and on moves with limits."""
SMALL = ("gde3", "moead-de")
SMALL_POPULATION = (("population", 20),)
"""Of these with the smallest budget: a hundred individuals have ten generations there."""
CENTRAL = ("cmopso", "smsemoa", "moead", "nsga2+polish", "gde3+polish", "random")
"""Methods of candidates that are run at the centre beside these."""
RANDOM_STARTS = (("continuation", False),)
"""Settings of `slsqp` by which each of its starts is random."""
AT_FEW = ("nsga2", "gde3", "moead-de")
"""Searches of 20 individuals that are run with 200 candidates."""
FOR_FEW = ("es", "gp")
"""Searches without a population, made for few candidates."""
AT_LARGE = ("gde3", "moead-de", "nsga2", "memetic", "slsqp")
OF_KINDS = ("nsga2", "gde3", "moead-de", "memetic", "slsqp")
PEAKS = ("peak_torque", "peak_deflection")
OF_OBJECTIVES = ("nsga2", "nsga3", "gde3", "moead-de")
GRID = (50, 200)
"""Points of the gradient's fronts of three and four objectives."""
NOISES = (0.01, 0.05)
NOISY = ("nsga2", "gde3", "moead-de", "mo-cma-es", "slsqp")
PAPER = {"nsga2-paper": 100_000, "vepso": 40_000}
"""The paper's methods with the paper's candidates."""
FURTHER = ("moead-de", "gde3", "nsga2", "slsqp")
"""Methods on moves with a robust residual, other profiles or an integer."""
FURTHER_ROUNDS = 5
FAMILY_TERMS = 10
"""Coefficients of every family of profiles: three Gaussians have as many."""
AGAIN = 5
"""Evaluations whose mean a search may take where there is noise; each counts."""
WIDE_STEPS = (0.01, 0.1)
"""Steps of differences as shares of the box, where a noise hides what small ones tell."""


@dataclass(frozen=True)
class Planned:
    """A job of the plan.

    Attributes
    ----------
    axis : str
        The file that keeps its run.
    round : int
        Its seed, or the round in which a method without a seed is run.
    case : Case
        Its problem.
    method : str
        As of `Job`.
    budget : int, optional
        Candidates; a gradient method has none.
    settings : tuple of (str, value)
        As of `Job`.
    noise : float
        Share of residual and energy by which a search sees them wrong, as of `Job`.
    reevaluate : int
        Evaluations of a candidate whose mean counts, as of `Job`.
    in_turn : bool
        Whether a search takes every value of an integer in turn, each with an equal part of the
        candidates.
    """

    axis: str
    round: int
    case: Case
    method: str
    budget: int | None = None
    settings: tuple[tuple[str, Any], ...] = ()
    noise: float = 0.0
    reevaluate: int = 1
    in_turn: bool = False

    @property
    def key(self) -> tuple[str, str, str, str, int]:
        """Key that tells the run from all others."""
        return self.case.name, self.method, self.words, str(self.budget or ""), self.round

    @property
    def words(self) -> str:
        """Settings, evaluations and noise, as a table states them."""
        stated = [*self.settings]
        if self.reevaluate > 1:
            stated.append(("reevaluate", self.reevaluate))
        if self.noise:
            stated.append(("noise", self.noise))
        if self.in_turn:
            stated.append(("in-turn", True))
        return " ".join(f"{name}={value}" for name, value in stated)

    @property
    def takes_every_number(self) -> bool:
        """Return whether every value of an integer is taken, as the gradient always does."""
        return self.in_turn or (self.case.has_integer and self.method == "epsilon")

    @property
    def of_seed(self) -> str:
        """Candidates and seed of a search that takes every number, for the name of its file."""
        return f"-{self.budget}-seed{self.round}" if self.in_turn else ""

    def job(self, folder: Path) -> Job:
        """The job of the bench."""
        return Job(
            self.case.problem(folder),
            self.method,
            seed=self.round,
            budget=self.budget,
            settings=dict(self.settings),
            noise=self.noise,
            reevaluate=self.reevaluate,
        )


def first_of_plants(moves: Sequence[Move], count: int) -> list[Move]:
    """The first moves of every plant."""
    chosen = list[Move]()
    taken = dict[str, int]()
    for move in moves:
        taken[move.plant.name] = taken.get(move.plant.name, 0) + 1
        if taken[move.plant.name] <= count:
            chosen.append(move)
    return chosen


Settings = Mapping[tuple[str, str], tuple[tuple[str, Any], ...]]
"""Tuned settings by cell and method."""


def rounds(moves: Sequence[Move], tuned_settings: Settings) -> Iterator[Planned]:
    """The whole plan, one round after another, with the tuned settings that there are."""
    tested = [move for move in moves if not move.tuning]
    for seed in range(max(SEEDS.values())):
        balanced = first_of_plants(tested, 2)
        remaining = [move for move in tested if move not in balanced]
        yield from centre(tested, seed)
        yield from limited(balanced, seed)
        yield from few(balanced, seed)
        yield from crossing(balanced, seed)
        yield from kinds(balanced, seed)
        yield from papers(balanced, seed)
        yield from noise(balanced, seed)
        yield from objectives(balanced, seed)
        yield from further(balanced, seed)
        yield from tuned(tested, balanced, tuned_settings, seed)
        yield from large(tested, seed)
        yield from alone(remaining, seed)
        yield from papers(remaining, seed)
        yield from crossing(remaining, seed)
        yield from limited(remaining, seed)
        yield from million(tested, seed)


def centre(tested: Sequence[Move], seed: int) -> Iterator[Planned]:
    """All methods with six coefficients, 10,000 candidates, absolute power."""
    if seed >= SEEDS[10_000]:
        return
    for move in tested:
        case = Case(move)
        for method in (*CROSSED, *CENTRAL):
            yield Planned("centre", seed, case, method, 10_000)
        yield Planned("centre", seed, case, "slsqp", 10_000, RANDOM_STARTS)
        if seed < 2:  # the second to see that it repeats itself
            for points in LADDER:
                yield Planned("centre", seed, case, "epsilon", None, (("points", points),))
        yield Planned("centre", seed, case, "multistart", None, (("starts", 100),))
    if seed == 1:  # they take long, and their fronts are those of SQP
        for move in first_of_plants(tested, 1):
            yield Planned("centre", seed, Case(move), "epsilon:ipopt", None, (("points", 20),))


def own(method: str, budget: int) -> tuple[tuple[str, Any], ...]:
    """Return the population of a method with its usual settings, where few candidates change it."""
    preset = PRESETS[method]
    changes = preset.population_for(budget) != preset.population
    return (("population", preset.population),) if changes else ()


def crossing(moves: Sequence[Move], seed: int) -> Iterator[Planned]:
    """Coefficients by budget: first two moves of every plant, the others when all else is done."""
    if not seed:
        for terms in TERMS:
            for move in moves if terms != CENTRE_TERMS else ():
                for points in LADDER[:-1]:
                    yield Planned(
                        "crossing", 0, Case(move, terms), "epsilon", None, (("points", points),)
                    )
    for budget in BUDGETS:
        for terms in TERMS:
            if (terms, budget) == (CENTRE_TERMS, 10_000) or seed >= SEEDS[budget]:
                continue
            for move in moves:
                case = Case(move, terms)
                for method in CROSSED:
                    yield Planned("crossing", seed, case, method, budget, own(method, budget))
                for method in SMALL if budget == BUDGETS[0] else ():
                    yield Planned("crossing", seed, case, method, budget, SMALL_POPULATION)


def limited(moves: Sequence[Move], seed: int) -> Iterator[Planned]:
    """Limits of torque, or of acceleration and jerk, tight and loose."""
    for limits in LIMITS:
        for move in moves:
            case = Case(move, limits=limits)
            for points in LADDER[:-1] if not seed else ():
                yield Planned("limits", 0, case, "epsilon", None, (("points", points),))
            for budget in BUDGETS:
                for method in CROSSED:
                    small = budget == BUDGETS[0] and method in AT_FEW
                    settings = SMALL_POPULATION if small else own(method, budget)
                    yield Planned("limits", seed, case, method, budget, settings)
            for method in FOR_FEW:
                yield Planned("limits", seed, case, method, BUDGETS[0])
            yield from limited_with_few(case, seed)


def limited_with_few(case: Case, seed: int) -> Iterator[Planned]:
    """Methods for few candidates, and finite-difference SLSQP, with 200 candidates and limits."""
    for method in FOR_FEW:
        yield Planned("limits", seed, case, method, FEW)
    for method in SMALL:
        yield Planned("limits", seed, case, method, FEW, SMALL_POPULATION)
    yield Planned("limits", seed, case, "slsqp", FEW)


def few(moves: Sequence[Move], seed: int) -> Iterator[Planned]:
    """200 candidates, without and with noise; with noise 1,000 as well.

    Without noise only the methods for few candidates are run with 1,000 here: the others are in
    the map.
    """
    yield from alone(moves, seed)
    for share in (0.0, NOISES[0]):
        for budget in (FEW, *BUDGETS[:1]) if share else (FEW,):
            for move in moves:
                case = Case(move)
                for method in AT_FEW:
                    yield Planned("few", seed, case, method, budget, SMALL_POPULATION, share)
                for method in FOR_FEW:
                    yield Planned("few", seed, case, method, budget, noise=share)
                yield Planned("few", seed, case, "random", budget, noise=share)
                settings = (("step", WIDE_STEPS[0]),) if share else ()
                yield Planned("few", seed, case, "slsqp", budget, settings, share)


def alone(moves: Sequence[Move], seed: int) -> Iterator[Planned]:
    """Searches without a population, with 1,000 candidates: the map has the others."""
    for move in moves:
        for method in FOR_FEW:
            yield Planned("few", seed, Case(move), method, BUDGETS[0])


def kinds(moves: Sequence[Move], seed: int) -> Iterator[Planned]:
    """Kinds of energy."""
    for kind in KINDS:
        for move in moves:
            case = Case(move, kind=kind)
            for method in OF_KINDS:
                yield Planned("energy", seed, case, method, 10_000)
            if not seed:
                yield Planned("energy", 0, case, "slsqp", 10_000, RANDOM_STARTS)
                points = 20 if kind == "motor-map" else 50  # the solver takes long where it jumps
                yield Planned("energy", 0, case, "epsilon", None, (("points", points),))


def papers(moves: Sequence[Move], seed: int) -> Iterator[Planned]:
    """The paper's methods with the paper's settings and candidates."""
    for method, budget in PAPER.items():
        if seed < SEEDS[budget]:
            for move in moves:
                yield Planned("paper", seed, Case(move), method, budget)


def noise(moves: Sequence[Move], seed: int) -> Iterator[Planned]:
    """Residual and energy with noise, for what sees values alone."""
    for share in NOISES:
        for move in moves:
            for method in NOISY:
                yield Planned("noise", seed, Case(move), method, 10_000, noise=share)
            yield Planned(
                "noise", seed, Case(move), "moead-de", 10_000, noise=share, reevaluate=AGAIN
            )
            for step in WIDE_STEPS:
                settings = (("step", step),)
                yield Planned("noise", seed, Case(move), "slsqp", 10_000, settings, noise=share)
            if not seed:
                yield Planned("noise", 0, Case(move), "slsqp", 10_000, RANDOM_STARTS, noise=share)


def objectives(moves: Sequence[Move], seed: int) -> Iterator[Planned]:
    """Three objectives, with the peak torque, and four, with the peak deflection as well."""
    for count in (1, 2):
        for move in moves:
            case = Case(move, peaks=PEAKS[:count])
            for method in OF_OBJECTIVES:
                yield Planned("objectives", seed, case, method, 10_000)
            for points in GRID if not seed else ():
                yield Planned("objectives", 0, case, "epsilon", None, (("points", points),))


def further(moves: Sequence[Move], seed: int) -> Iterator[Planned]:
    """Robust residuals, families of profiles, and integers of two kinds."""
    cases = [
        *(("robust", Case(move, is_robust=True)) for move in moves),
        *(
            ("profiles", Case(move, FAMILY_TERMS, family=family))
            for family in FAMILIES
            for move in moves
            if family != CENTRE_FAMILY  # the crossing has the polynomial
        ),
        *(("integers", Case(move, kind=kind)) for kind in INTEGERS for move in moves),
    ]
    for axis, case in cases if seed < FURTHER_ROUNDS else ():
        yield from further_of(axis, case, seed)


def further_of(axis: str, case: Case, seed: int) -> Iterator[Planned]:
    """The methods of a case; what the energy axis has of an integer is not planned again."""
    is_known = case.kind in KINDS
    if not seed and not is_known:
        yield Planned(axis, 0, case, "epsilon", None, (("points", 50),))
    for budget in BUDGETS:
        for method in FURTHER if (budget == BUDGETS[0] or not is_known) else ():
            small = budget == BUDGETS[0] and method in AT_FEW
            yield Planned(axis, seed, case, method, budget, SMALL_POPULATION if small else ())
        if case.has_integer:
            yield Planned(axis, seed, case, "slsqp", budget, in_turn=True)
    yield Planned(axis, seed, case, "es", BUDGETS[0])


def tuned(
    tested: Sequence[Move], balanced: Sequence[Move], settings: Settings, seed: int
) -> Iterator[Planned]:
    """Tuned settings in the cells where they were tuned, at the centre on all moves.

    Where no trial is better than the library's settings, their runs are those of the other axes.
    """
    for (name, method), values in settings.items():
        cell = TUNED_CELLS[name]
        if are_usual(method, cell, values):
            continue
        again = int(dict(values).get("reevaluate", 1))
        own_settings = tuple(value for value in values if value[0] != "reevaluate")
        for case in cell.to_test(tested if name == "centre" else balanced):
            yield Planned("tuned", seed, case, method, cell.budget, own_settings, cell.noise, again)


def are_usual(method: str, cell: TunedCell, settings: Sequence[tuple[str, Any]]) -> bool:
    """Return whether settings are those with which a method is run in a cell without noise."""
    preset = PRESETS[method]
    usual: dict[str, Any] = {setting.name: setting.default for setting in preset.settings}
    usual["population"] = preset.population
    if cell.budget <= BUDGETS[0]:
        usual |= dict(SMALL_POPULATION)
    return not cell.noise and all(usual[name] == value for name, value in settings)


def large(tested: Sequence[Move], seed: int) -> Iterator[Planned]:
    """Coefficients with the large budget, on two moves of every plant: fewer tell no difference."""
    if seed >= SEEDS[LARGE]:
        return
    for terms in (6, 2, 16, 4, 10, 24):
        for move in first_of_plants(tested, 2):
            case = Case(move, terms)
            if not seed and terms != CENTRE_TERMS:
                yield Planned("large", 0, case, "epsilon", None, (("points", LONGEST),))
            for method in AT_LARGE:
                yield Planned("large", seed, case, method, LARGE)


def million(tested: Sequence[Move], seed: int) -> Iterator[Planned]:
    """A million candidates on one move of three plants, six and sixteen coefficients."""
    if seed >= SEEDS[MILLION]:
        return
    for terms in (CENTRE_TERMS, 16):
        for move in first_of_plants(tested, 1)[:3]:
            for method in ("gde3", "moead-de"):
                yield Planned("million", seed, Case(move, terms), method, MILLION)
