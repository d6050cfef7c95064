"""The methods that are known by name: one entry each, with the defaults of its settings.

pymoo is imported when one is built and not before: it takes longer to load than all of quietarm,
and a list of names does not need it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from numbers import Integral
from typing import TYPE_CHECKING

from quietarm.metaheuristics.algorithms.search_method import SearchMethod
from quietarm.metaheuristics.algorithms.settings import MethodSetting, Value, with_defaults
from quietarm.ocp.checks import known, unknown

if TYPE_CHECKING:
    from pymoo.core.algorithm import Algorithm

PAPER_BOX: dict[str, float] = {"single-link": 0.2, "arm-on-flexible-link": 0.5}
"""Largest absolute coefficient in the paper's searches, by plant, of eqs (12) and (17)."""


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
    defaults : mapping
        Its arguments that may be set, as `settings` names them, with their defaults.
    population, generations : int
        Individuals (particles of each swarm, for VEPSO) and generations by default: pymoo's own
        population, and in all as many candidates as the paper gives VEPSO.
    by_swarms : bool
        Whether each objective has a population, which are all evaluated in a generation: VEPSO.
    by_directions : bool
        Whether it takes reference directions: as many as individuals, evenly spread.
    keeps_limits : bool
        Whether it can search a task that has limits.
    needs : str
        A library beyond pymoo's that it needs, which `quietarm[NAME]` installs.
    is_function : bool
        Whether it is a function of a problem's recorded function, a seed and a budget, which has no
        population: a generation is a candidate.
    residual_and_energy : bool
        Whether it is for these two objectives alone.
    takes_gradients : bool
        Whether it takes steps of the model's gradient, which no noise reaches.
    most : int
        Most individuals. pymoo's methods compare all pairs: these fill up to 2 GB of memory.
    own : type, optional
        The user's own class, in place of the `kind`.
    """

    name: str
    label: str
    source: str
    kind: str
    defaults: Mapping[str, Value] = field(default_factory=dict, hash=False)
    population: int = 100
    generations: int = 400
    by_swarms: bool = False
    by_directions: bool = False
    keeps_limits: bool = True
    needs: str = ""
    is_function: bool = False
    residual_and_energy: bool = False
    takes_gradients: bool = False
    most: int = 10_000
    own: type[SearchMethod] | None = None

    @classmethod
    def of_own(cls, own: type[SearchMethod]) -> Preset:
        """The entry of a user's own class."""
        is_function = own.run is not SearchMethod.run
        return cls(
            own.name,
            own.label,
            "one's own",
            "",
            own.defaults(),
            population=1 if is_function else own.population,
            generations=own.budget if is_function else own.generations,
            is_function=is_function,
            own=own,
        )

    @property
    def settings(self) -> tuple[MethodSetting, ...]:
        """Its settings beside population and generations."""
        if self.own is not None:
            return tuple(
                MethodSetting(name, name, value, "of one's own", self.own.check)
                for name, value in self.defaults.items()
            )
        return tuple(MethodSetting.of(argument, value) for argument, value in self.defaults.items())

    def build(
        self,
        population: int,
        settings: Mapping[str, object] | None = None,
        objectives: int = 2,
    ) -> Algorithm | Callable[..., None]:
        """A new algorithm, or a function.

        Parameters
        ----------
        population : int
            Individuals, or particles in a swarm.
        settings : mapping, optional
            Values by the names of `settings`; the defaults for all others.
        objectives : int
            How many objectives it is for.

        Returns
        -------
        Algorithm or callable
            One that was not run; of a method that `is_function` that function, with its settings.

        Raises
        ------
        ValueError
            When a setting or the population is not known or out of range, or a library is missing.
        """
        values = self.checked(population, settings)
        if self.own is not None:
            own = self.own(**values)
            return own if self.is_function else own.make(population)
        from quietarm.metaheuristics.algorithms.building import built

        return built(self, population, values, objectives)

    def checked(
        self, population: int, settings: Mapping[str, object] | None = None
    ) -> dict[str, Value]:
        """The values of all settings; arguments and errors as for `build`.

        A population is refused that would never end, or fill the memory.
        """
        values = with_defaults(self.name, self.settings, settings or {})
        if self.is_function and population != 1:
            raise ValueError(f"{self.name} has no population; leave it out")
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

    def evaluations(self, population: int, generations: int, objectives: int = 2) -> int:
        """Candidates that a search of so many objectives evaluates.

        They are fewer only if crossover finds too few new ones.
        """
        return (objectives if self.by_swarms else 1) * population * generations

    def unfit_for(self, objectives: int, noise: float = 0.0) -> str:
        """Why it is not for a problem of so many objectives, or with noise; empty where it is."""
        if self.residual_and_energy and objectives > 2:
            return f"{self.name} is for residual and energy alone, not for {objectives} objectives"
        if self.takes_gradients and noise > 0:
            return f"{self.name} takes steps of the model's gradient, which has no noise"
        return ""

    def refuse_unfit(self, objectives: int, noise: float = 0.0) -> None:
        """Refuse a problem that it is not for; ValueError says what to give."""
        if reason := self.unfit_for(objectives, noise):
            raise ValueError(f"{reason}; give another method, as moead-de")

    def refuse_less_than_one(self, evaluations: int, population: int, objectives: int = 2) -> None:
        """Refuse whole numbers of evaluations that are less than a generation."""
        size = self.evaluations(population, 1, objectives)
        if isinstance(evaluations, Integral) and evaluations < size:
            raise ValueError(
                f"evaluations is {evaluations}, less than one generation of {self.name}, {size}; "
                "give more, or a smaller population"
            )


def preset_of(name: str) -> Preset:
    """A method by its name; ValueError suggests the nearest one."""
    if name not in PRESETS:
        raise ValueError(unknown("method", name, PRESETS))
    return PRESETS[name]


def _genetic(
    pairs: float, eta: float, children: float = 0.9, gene: float | None = None
) -> dict[str, Value]:
    """Simulated binary crossover and polynomial mutation."""
    return {
        "crossover.prob": pairs,
        "crossover.prob_var": 0.5,
        "crossover.eta": eta,
        "mutation.prob": children,
        "mutation.prob_var": gene,
        "mutation.eta": 20.0,
    }


def _differential(rate: float) -> dict[str, Value]:
    return {
        "variant": "DE/rand/1/bin",
        "CR": rate,
        "F": None,
        "gamma": 1e-4,
        "de_repair": "bounce-back",
    }


_DECOMPOSED: dict[str, Value] = {
    "n_neighbors": 20,
    "prob_neighbor_mating": 0.9,
    "replaced": 2,
    "CR": 1.0,
    "F": 0.5,
    "mutation_eta": 20.0,
}
_PAIRS = _genetic(0.9, 15.0)
_DIRECTIONS = _genetic(1.0, 30.0)
_OURS = "quietarm.metaheuristics.algorithms"
_PYMOO = "pymoo.algorithms.moo"
_DEB = "Deb, Pratap, Agarwal and Meyarivan 2002"

_ALL = (
    Preset(
        "vepso",
        "VEPSO",
        "Parsopoulos and Vrahatis 2002",
        f"{_OURS}.vepso:VEPSO",
        {
            "boundary": "clip",
            "velocity_limit": 1.0,
            "archive_size": None,
            "rule.inertia_start": 1.0,
            "rule.inertia_end": 1.0,
            "rule.constriction": 0.729,
            "rule.cognitive": 2.05,
            "rule.social": 2.05,
        },
        generations=200,
        by_swarms=True,
        most=100_000,
    ),
    Preset(
        "nsga2",
        "NSGA-II",
        _DEB,
        f"{_OURS}.nsga2:PaperNSGA2",
        _genetic(0.9, 15.0, 1.0),
        most=100_000,
    ),
    Preset(
        "nsga2-paper",
        "NSGA-II (paper)",
        _DEB,
        f"{_OURS}.nsga2:PaperNSGA2",
        _genetic(0.8, 15.0, 1.0, 0.01),
        population=200,
        generations=500,
        most=100_000,
    ),
    Preset(
        "nsga3",
        "NSGA-III",
        "Deb and Jain 2014",
        f"{_OURS}.pymoo_fixes:NSGA3",
        _DIRECTIONS,
        by_directions=True,
    ),
    Preset(
        "unsga3",
        "U-NSGA-III",
        "Seada and Deb 2016",
        f"{_OURS}.pymoo_fixes:UNSGA3",
        _DIRECTIONS,
        by_directions=True,
    ),
    Preset(
        "spea2",
        "SPEA2",
        "Zitzler, Laumanns and Thiele 2001",
        f"{_OURS}.pymoo_fixes:SPEA2",
        {**_PAIRS, "normalize": True},
        most=2_000,
    ),
    Preset(
        "smsemoa",
        "SMS-EMOA",
        "Beume, Naujoks and Emmerich 2007",
        f"{_PYMOO}.sms:SMSEMOA",
        {**_PAIRS, "normalize": True},
    ),
    Preset(
        "moead",
        "MOEA/D",
        "Zhang and Li 2007",
        f"{_PYMOO}.moead:ParallelMOEAD",
        {**_genetic(1.0, 20.0), "n_neighbors": 20, "prob_neighbor_mating": 0.9},
        by_directions=True,
        keeps_limits=False,
    ),
    Preset(
        "moead-de",
        "MOEA/D-DE",
        "Li and Zhang 2009",
        f"{_OURS}.moead_de:ScaledMOEAD",
        _DECOMPOSED,
        by_directions=True,
    ),
    Preset(
        "memetic",
        "memetic MOEA/D-DE",
        "Li and Zhang 2009, with steps of the gradient",
        f"{_OURS}.memetic:MemeticMOEAD",
        {
            **_DECOMPOSED,
            "gradient_every": 10,
            "gradient_points": 10,
            "gradient_iterations": 5,
        },
        population=50,
        generations=800,
        by_directions=True,
        residual_and_energy=True,
        takes_gradients=True,
    ),
    Preset(
        "mo-cma-es",
        "MO-CMA-ES",
        "Igel, Hansen and Roth 2007",
        f"{_OURS}.mo_cma_es:MOCMAES",
        {"first_step": 0.2},
        population=30,
        generations=1_333,
        most=2_000,
    ),
    Preset(
        "agemoea",
        "AGE-MOEA",
        "Panichella 2019",
        f"{_PYMOO}.age:AGEMOEA",
        _PAIRS,
        needs="numba",
        most=5_000,
    ),
    Preset(
        "agemoea2",
        "AGE-MOEA-II",
        "Panichella 2022",
        f"{_PYMOO}.age2:AGEMOEA2",
        _PAIRS,
        needs="numba",
        most=5_000,
    ),
    Preset(
        "rvea",
        "RVEA",
        "Cheng, Jin, Olhofer and Sendhoff 2016",
        f"{_PYMOO}.rvea:RVEA",
        {**_DIRECTIONS, "alpha": 2.0, "adapt_freq": 0.1},
        by_directions=True,
        most=5_000,
    ),
    Preset(
        "ctaea",
        "C-TAEA",
        "Li, Chen, Fu and Yao 2019",
        f"{_OURS}.pymoo_fixes:CTAEA",
        _DIRECTIONS,
        by_directions=True,
        most=5_000,
    ),
    Preset(
        "mopso-cd",
        "MOPSO-CD",
        "Raquel and Naval 2005",
        f"{_OURS}.pymoo_fixes:MOPSO_CD",
        {
            "w": 0.6,
            "c1": 2.0,
            "c2": 2.0,
            "max_velocity_rate": 0.5,
            "archive_size": 200,
        },
    ),
    Preset(
        "cmopso",
        "CMOPSO",
        "Zhang, Zheng, Cheng, Qiu and Jin 2018",
        f"{_OURS}.pymoo_fixes:CMOPSO",
        {
            "elite_size": 10,
            "mutation_rate": 0.5,
            "max_velocity_rate": 0.2,
            "initial_velocity": "random",
        },
    ),
    Preset(
        "gde3",
        "GDE3",
        "Kukkonen and Lampinen 2005",
        f"{_PYMOO}.gde3:GDE3",
        _differential(0.5),
    ),
    Preset(
        "nsde",
        "NSDE",
        "Iorio and Li 2004",
        f"{_PYMOO}.nsde:NSDE",
        _differential(0.7),
    ),
    Preset(
        "nsder",
        "NSDE-R",
        "Reddy and Dulikravich 2019",
        f"{_PYMOO}.nsder:NSDER",
        _differential(0.7),
        by_directions=True,
    ),
    Preset(
        "omni",
        "Omni-Optimizer",
        "Deb and Tiwari 2008",
        f"{_PYMOO}.omni:OmniOptimizer",
        {
            **_genetic(0.8, 20.0),
            "delta": 0.001,
            "obj_crowding": True,
            "var_crowding": True,
        },
    ),
    Preset(
        "slsqp",
        "SLSQP with differences",
        "Kraft 1988",
        f"{_OURS}.differences:slsqp",
        {"step": 1e-6, "continuation": True},
        population=1,
        generations=40_000,
        is_function=True,
        residual_and_energy=True,
    ),
    Preset(
        "random",
        "random search",
        "Bergstra and Bengio 2012",
        f"{_OURS}.sampling:RandomSearch",
        most=100_000,
    ),
    Preset(
        "lhs",
        "latin hypercubes",
        "McKay, Beckman and Conover 1979",
        f"{_OURS}.sampling:LatinHypercubes",
        most=2_000,
    ),
)


class Presets(Mapping[str, Preset]):
    """Every method by its name: quietarm's, and then those of the user's own classes.

    ValueError where one of these has the name of quietarm's.
    """

    _shipped: Mapping[str, Preset] = {preset.name: preset for preset in _ALL}

    def _all(self) -> Mapping[str, Preset]:
        own = known(SearchMethod)
        for name, kind in own.items():
            if name in self._shipped:
                raise ValueError(
                    f"name {name!r} of the search {kind.__name__} is quietarm's own; give another"
                )
        return {**self._shipped, **{name: _of_own(kind) for name, kind in own.items()}}

    def __getitem__(self, name: str) -> Preset:
        return self._shipped[name] if name in self._shipped else self._all()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._all())

    def __len__(self) -> int:
        return len(self._all())


@cache
def _of_own(kind: type[SearchMethod]) -> Preset:
    """The one entry of a class."""
    return Preset.of_own(kind)


PRESETS: Mapping[str, Preset] = Presets()
"""By name. Section 3.1 has 100 particles in a swarm, 200 iterations. Section 3.2 has population
200, 500 generations, crossover 0.8, mutation 0.01 (`nsga2.py`). All other settings are pymoo's
defaults."""
