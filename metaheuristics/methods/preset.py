"""A method that is known by name, and how an algorithm is made of it.

pymoo is imported when one is made and not before: it takes longer to load than all of quietarm,
and a list of names does not need it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib.util import find_spec
from numbers import Integral
from typing import TYPE_CHECKING

from quietarm.metaheuristics.methods.search_method import SearchMethod
from quietarm.metaheuristics.methods.settings import MethodSetting, Value, with_defaults
from quietarm.ocp.checks import install
from quietarm.ocp.solvers.choice import SOLVERS
from quietarm.ocp.solvers.sqp import Sqp

if TYPE_CHECKING:
    from pymoo.core.algorithm import Algorithm


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
    fixed_population : bool
        Whether the population is the paper's, however few candidates there are.
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
    fixed_population: bool = False
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
        """The settings beside population and generations."""
        if self.own is not None:
            return tuple(
                MethodSetting(name, name, value, "of one's own", self.own.check)
                for name, value in self.defaults.items()
            )
        settings = [MethodSetting.of(argument, value) for argument, value in self.defaults.items()]
        if self.takes_gradients:  # how many iterations it has is a setting of the method
            options = SOLVERS[Sqp.name].stated_options()
            own = [entry for entry in options if entry.name != "iterations"]
            settings += map(MethodSetting.of_solver, own)
        return tuple(settings)

    @property
    def setting_names(self) -> set[str]:
        """The names of these settings."""
        return {setting.name for setting in self.settings}

    def stated(self, values: Mapping[str, Value]) -> dict[str, Value]:
        """Return the settings that a record states; a solver's option only if it was changed."""
        usual = {setting.name: setting.default for setting in self.settings if setting.is_of_solver}
        return {
            name: value
            for name, value in values.items()
            if name not in usual or value != usual[name]
        }

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
        if self.needs and find_spec(self.needs) is None:
            raise ValueError(f"{self.name} needs {self.needs}; {install(self.needs)}")
        from quietarm.metaheuristics.methods.building import directions, with_arguments

        arguments = {setting.argument: values[setting.name] for setting in self.settings}
        method = with_arguments(self.kind, arguments)
        if self.is_function:
            return method
        return method(directions(population, objectives) if self.by_directions else population)

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

    def population_for(self, evaluations: int | None) -> int:
        """Return the population by default for so many candidates in all; its own without them.

        Of few candidates it is so small that they suffice for 50 generations, and 10 at least.
        """
        generations = 50
        least = 10
        unknown = not isinstance(evaluations, Integral)  # refused elsewhere, or none at all
        if unknown or self.fixed_population or self.is_function or self.own is not None:
            return self.population
        return min(self.population, max(least, int(evaluations) // generations))

    def unfit_for(self, objectives: int, noise: float = 0.0, of_model: bool = True) -> str:
        """Say why the method does not fit so many objectives, noise, or a user's own function.

        Empty if it fits.
        """
        if self.residual_and_energy and objectives > 2:
            return f"{self.name} is for residual and energy alone, not for {objectives} objectives"
        if self.takes_gradients and not of_model:
            return f"{self.name} takes steps of a model's gradient, and a function has none"
        if self.takes_gradients and noise > 0:
            return f"{self.name} takes steps of the model's gradient, which has no noise"
        return ""

    def refuse_unfit(self, objectives: int, noise: float = 0.0, of_model: bool = True) -> None:
        """Refuse a problem that it is not for; ValueError says what to give."""
        if reason := self.unfit_for(objectives, noise, of_model):
            raise ValueError(f"{reason}; give another method, such as moead-de")

    def refuse_less_than_one(self, evaluations: int, population: int, objectives: int = 2) -> None:
        """Refuse whole numbers of evaluations that are less than a generation."""
        size = self.evaluations(population, 1, objectives)
        if isinstance(evaluations, Integral) and evaluations < size:
            raise ValueError(
                f"evaluations is {evaluations}, less than one generation of {self.name}, {size}; "
                "give more, or a smaller population"
            )
