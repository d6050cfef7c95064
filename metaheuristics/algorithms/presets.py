"""The methods that are known by name: one entry each, with its settings and their defaults.

pymoo is imported when one is built and not before: it takes longer to load than all of quietarm,
and a list of names does not need it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from quietarm.metaheuristics.algorithms.settings import (
    Setting,
    Value,
    count,
    index_of_spread,
    one_of,
    positive_share,
    scale,
    share,
    with_defaults,
    yes_or_no,
)
from quietarm.ocp.checks import not_negative, positive, unknown

if TYPE_CHECKING:
    from pymoo.core.algorithm import Algorithm

FEW = 20
"""With fewer generations a method has hardly begun."""
PAPER_BOX: dict[str, float] = {"single-link": 0.2, "arm-on-flexible-link": 0.5}
"""Largest absolute coefficient in the paper's searches, by plant, of eqs (12) and (17)."""
POPULATION, GENERATIONS = 100, 400
"""Of the methods that the paper does not use: pymoo's own population, and in all as many candidates
as the paper gives VEPSO."""


@dataclass(frozen=True)
class Preset:
    """A method that is known by name.

    Attributes
    ----------
    name, label : str
        What it is called in a program and in a text.
    source : str
        Who published it, and when.
    kind : str
        Its class, as ``module:Class``.
    settings : tuple of Setting
        What it may be set to, beside population and generations.
    population, generations : int
        Individuals (particles of each swarm, for VEPSO) and generations by default.
    swarms : int
        How many populations are evaluated in a generation: two for VEPSO, else one.
    by_directions : bool
        Whether it takes reference directions: as many as individuals, evenly spread.
    keeps_limits : bool
        Whether it can search a task that has limits.
    needs : str
        A library beyond pymoo's that it needs, which `quietarm[NAME]` installs.
    most : int
        Most individuals. pymoo's methods compare all pairs: these fill up to 2 GB of memory.
    """

    name: str
    label: str
    source: str
    kind: str
    settings: tuple[Setting, ...]
    population: int = POPULATION
    generations: int = GENERATIONS
    swarms: int = 1
    by_directions: bool = False
    keeps_limits: bool = True
    needs: str = ""
    most: int = 10_000

    def build(self, population: int, settings: Mapping[str, object] | None = None) -> Algorithm:
        """A new algorithm.

        Parameters
        ----------
        population : int
            Individuals, or particles in a swarm.
        settings : mapping, optional
            Values by the names of `settings`; the defaults for all others.

        Returns
        -------
        Algorithm
            One that was not run.

        Raises
        ------
        ValueError
            When a setting or the population is not known or out of range, or a library is missing.
        """
        values = self.checked(population, settings)
        from quietarm.metaheuristics.algorithms.building import built

        return built(self, population, values)

    def checked(
        self, population: int, settings: Mapping[str, object] | None = None
    ) -> dict[str, Value]:
        """The values of all settings; arguments and errors as for `build`.

        A population is refused that would never end, or fill the memory.
        """
        values = with_defaults(self.name, self.settings, settings)
        if population > self.most:
            raise ValueError(
                f"population is {population}; give at most {self.most}: {self.name} compares all "
                "pairs, which fill the memory"
            )
        variant = values.get("variant")
        if isinstance(variant, str):  # as DE/rand/1/bin: pymoo looks for other vectors for ever
            least = 2 * int(variant.split("/")[2]) + 2
            if population < least:
                raise ValueError(
                    f"population is {population}; give at least {least}: {variant} takes so many "
                    "vectors that differ"
                )
        return values

    def evaluations(self, population: int, generations: int) -> int:
        """Candidates that a search evaluates.

        They are fewer only where crossing finds too few that differ from those that are known.
        """
        return self.swarms * population * generations

    def generations_for(self, evaluations: int, population: int | None = None) -> int:
        """How many whole generations so many evaluations are; ValueError where not even one."""
        size = self.swarms * (self.population if population is None else population)
        if evaluations < size:
            raise ValueError(
                f"evaluations is {evaluations}, less than one generation of {self.name}, {size}; "
                "give more, or a smaller population"
            )
        return evaluations // size

    def too_few(self, evaluations: int, population: int | None = None) -> str:
        """What to say where evaluations leave few generations; empty where they leave enough."""
        count = self.generations_for(evaluations, population)
        if count >= FEW or not self.settings:  # a baseline learns from no generation
            return ""
        size = self.population if population is None else population
        return (
            f"{evaluations} evaluations are {count} generations of {self.name} with a population "
            f"of {size}; a smaller population leaves more of them"
        )


def preset_of(name: str) -> Preset:
    """A method by its name; ValueError suggests the nearest one."""
    if name not in PRESETS:
        raise ValueError(unknown("method", name, PRESETS))
    return PRESETS[name]


def _sbx(share_of_pairs: float, eta: float) -> tuple[Setting, ...]:
    return (
        Setting("crossover", "crossover.prob", share_of_pairs,
                "share of the pairs that are crossed, by SBX", share),
        Setting("crossover_gene", "crossover.prob_var", 0.5,
                "share of the coefficients that cross", positive_share),
        Setting("crossover_eta", "crossover.eta", eta,
                "how near to its parents a child is", index_of_spread),
    )  # fmt: skip


def _pm(share_of_children: float = 0.9, gene: float | None = None) -> tuple[Setting, ...]:
    unset = "" if gene else "; 1 / their number, at most 0.5, by default"
    return (
        Setting("mutation", "mutation.prob", share_of_children,
                "share of the children that may mutate", share),
        Setting("mutation_gene", "mutation.prob_var", gene,
                f"share of the coefficients that mutate{unset}", share),
        Setting("mutation_eta", "mutation.eta", 20.0, "how small a mutation is", index_of_spread),
    )  # fmt: skip


def _difference(rate: float) -> tuple[Setting, ...]:
    variants = (
        f"DE/{base}/{number}/{cross}"
        for base in ("rand", "best", "current-to-best", "current-to-rand", "ranked")
        for number in (1, 2)
        for cross in ("bin", "exp")
    )
    return (
        Setting("variant", "variant", "DE/rand/1/bin",
                "which vectors differ, and how they cross", one_of(*variants)),
        Setting("crossover", "CR", rate, "share of the coefficients that cross", share),
        Setting("scale", "F", None,
                "factor of a difference; random from 0 to 1 by default", scale),
        Setting("jitter", "gamma", 1e-4,
                "how much the factor differs between coefficients", not_negative),
        Setting("repair", "de_repair", "bounce-back", "what happens beyond the box",
                one_of("bounce-back", "midway", "rand-init", "to-bounds")),
    )  # fmt: skip


def _velocity(argument: str, limit: float) -> Setting:
    words = "largest velocity of a coefficient, as a share of its box"
    return Setting("velocity_limit", argument, limit, words, positive)


_GENETIC = (*_sbx(0.9, 15.0), *_pm())
_BY_DIRECTIONS = (*_sbx(1.0, 30.0), *_pm())
_NORMALISE = Setting("normalise", "normalize", True,
                     "scale the objectives to the population", yes_or_no)  # fmt: skip
_OURS, _PYMOO = "quietarm.metaheuristics.algorithms", "pymoo.algorithms.moo"

_ALL = (
    Preset(
        "vepso", "VEPSO", "Parsopoulos and Vrahatis 2002", f"{_OURS}.vepso:VEPSO",
        (
            Setting("boundary", "boundary", "clip", "what happens beyond the box",
                    one_of("clip", "reflect")),
            _velocity("velocity_limit", 1.0),
            Setting("archive_size", "archive_size", None,
                    "most points of the front; all are kept by default", count(2)),
            Setting("inertia", "rule.inertia_start", 1.0,
                    "share of its velocity that a particle keeps at first", not_negative),
            Setting("last_inertia", "rule.inertia_end", 1.0, "that share at the end",
                    not_negative),
            Setting("constriction", "rule.constriction", 0.729, "factor of every velocity",
                    positive),
            Setting("cognitive", "rule.cognitive", 2.05, "pull to its own best", not_negative),
            Setting("social", "rule.social", 2.05, "pull to the next swarm's best", not_negative),
        ),
        population=100, generations=200, swarms=2, most=100_000,
    ),
    Preset("nsga2", "NSGA-II", "Deb, Pratap, Agarwal and Meyarivan 2002",
           f"{_OURS}.nsga2:PaperNSGA2", (*_sbx(0.9, 15.0), *_pm(1.0)), most=100_000),
    Preset(
        "nsga2-paper", "NSGA-II (paper)", "Deb, Pratap, Agarwal and Meyarivan 2002",
        f"{_OURS}.nsga2:PaperNSGA2", (*_sbx(0.8, 15.0), *_pm(1.0, 0.01)),
        population=200, generations=500, most=100_000,
    ),
    Preset("nsga3", "NSGA-III", "Deb and Jain 2014", f"{_OURS}.mended:NSGA3",
           _BY_DIRECTIONS, by_directions=True),
    Preset("unsga3", "U-NSGA-III", "Seada and Deb 2016", f"{_OURS}.mended:UNSGA3",
           _BY_DIRECTIONS, by_directions=True),
    Preset("spea2", "SPEA2", "Zitzler, Laumanns and Thiele 2001", f"{_OURS}.mended:SPEA2",
           (*_GENETIC, _NORMALISE), most=2_000),
    Preset("smsemoa", "SMS-EMOA", "Beume, Naujoks and Emmerich 2007", f"{_PYMOO}.sms:SMSEMOA",
           (*_GENETIC, _NORMALISE)),
    Preset(
        "moead", "MOEA/D", "Zhang and Li 2007", f"{_PYMOO}.moead:ParallelMOEAD",
        (
            *_sbx(1.0, 20.0), *_pm(),
            Setting("neighbours", "n_neighbors", 20,
                    "nearest directions that take a child", count(2)),
            Setting("neighbour_mating", "prob_neighbor_mating", 0.9,
                    "share of the pairs that come from these", share),
        ),
        by_directions=True, keeps_limits=False,
    ),
    Preset("agemoea", "AGE-MOEA", "Panichella 2019", f"{_PYMOO}.age:AGEMOEA", _GENETIC,
           needs="numba", most=5_000),
    Preset("agemoea2", "AGE-MOEA-II", "Panichella 2022", f"{_PYMOO}.age2:AGEMOEA2", _GENETIC,
           needs="numba", most=5_000),
    Preset(
        "rvea", "RVEA", "Cheng, Jin, Olhofer and Sendhoff 2016", f"{_PYMOO}.rvea:RVEA",
        (
            *_BY_DIRECTIONS,
            Setting("alpha", "alpha", 2.0, "how fast the penalty of an angle grows", positive),
            Setting("adaptation", "adapt_freq", 0.1,
                    "share of the generations between changes of the directions", positive_share),
        ),
        by_directions=True, most=5_000,
    ),
    Preset("ctaea", "C-TAEA", "Li, Chen, Fu and Yao 2019", f"{_OURS}.mended:CTAEA",
           _BY_DIRECTIONS, by_directions=True, most=5_000),
    Preset(
        "mopso-cd", "MOPSO-CD", "Raquel and Naval 2005", f"{_OURS}.mended:MOPSO_CD",
        (
            Setting("inertia", "w", 0.6, "share of its velocity that a particle keeps",
                    not_negative),
            Setting("cognitive", "c1", 2.0, "pull to its own best", not_negative),
            Setting("social", "c2", 2.0, "pull to a point of the front", not_negative),
            _velocity("max_velocity_rate", 0.5),
            Setting("archive_size", "archive_size", 200, "most points of the front", count(2)),
        ),
    ),
    Preset(
        "cmopso", "CMOPSO", "Zhang, Zheng, Cheng, Qiu and Jin 2018", f"{_OURS}.mended:CMOPSO",
        (
            Setting("elites", "elite_size", 10, "particles that the others learn from",
                    count(1)),
            Setting("mutation", "mutation_rate", 0.5, "share of the particles that may mutate",
                    share),
            _velocity("max_velocity_rate", 0.2),
            Setting("first_velocity", "initial_velocity", "random", "of the first population",
                    one_of("random", "zero")),
        ),
    ),
    Preset("gde3", "GDE3", "Kukkonen and Lampinen 2005", f"{_PYMOO}.gde3:GDE3",
           _difference(0.5)),
    Preset("nsde", "NSDE", "Iorio and Li 2004", f"{_PYMOO}.nsde:NSDE", _difference(0.7)),
    Preset("nsder", "NSDE-R", "Reddy and Dulikravich 2019", f"{_PYMOO}.nsder:NSDER",
           _difference(0.7), by_directions=True),
    Preset(
        "omni", "Omni-Optimizer", "Deb and Tiwari 2008", f"{_PYMOO}.omni:OmniOptimizer",
        (
            *_sbx(0.8, 20.0), *_pm(),
            Setting("delta", "delta", 0.001,
                    "difference that is too small to dominate, as a share of the range",
                    not_negative),
            Setting("objective_crowding", "obj_crowding", True, "spread the objectives",
                    yes_or_no),
            Setting("coefficient_crowding", "var_crowding", True, "spread the coefficients",
                    yes_or_no),
        ),
    ),
    Preset("random", "random search", "Bergstra and Bengio 2012",
           f"{_OURS}.sampling:RandomSearch", (), most=100_000),
    Preset("lhs", "latin hypercubes", "McKay, Beckman and Conover 1979",
           f"{_OURS}.sampling:LatinHypercubes", (), most=2_000),
)  # fmt: skip

PRESETS: Mapping[str, Preset] = {preset.name: preset for preset in _ALL}
"""By name. Section 3.1 has 100 particles in a swarm, 200 iterations. Section 3.2 has population
200, 500 generations, crossover 0.8, mutation 0.01 (`nsga2.py`). All other settings are pymoo's
defaults."""
