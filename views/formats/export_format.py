"""What a format of files is: its name and endings, what it may be told, and what it writes."""

from __future__ import annotations

from abc import ABC
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from math import inf
from pathlib import Path
from pkgutil import iter_modules
from typing import Any, ClassVar, NamedTuple

from quietarm.ocp import Front, Plan, QuietarmError
from quietarm.ocp.checks import failed_in, finite, known, listed, quoted, ships, unknown, whole

PLAN = "plan"
FRONT = "front"
SEVERAL = "several"
DATASET = "dataset"
TAKEN = (PLAN, FRONT, SEVERAL, DATASET)
"""What a format may take: a plan, a front, several of what it takes, the moves of a sweep."""
_TAKEN_BY_COMMANDS = (".json", ".png", ".pdf", ".svg", ".zarr", ".tex", ".txt")
"""Endings that commands give to something else."""
_OPTIONS = ("output", "format", "form", "plans", "plan", "path", "report", "quiet", "help")
"""What `quietarm export` and `export_plan` have already."""

Content = str | bytes
Answers = Mapping[str, Any] | Sequence[Any]
"""What is exported: plans, fronts, or the moves of a sweep, perhaps by what they are called."""
Progress = Callable[[int, int], object]


class Exported(NamedTuple):
    """What a format makes: every file's content, written all or none, and what is said of it."""

    files: Mapping[Path, Content]
    notes: Sequence[str] = ()


@dataclass(frozen=True)
class Setting:
    """What a format may be told: `rate=500` of `export_plan`, `--rate 500` of quietarm export.

    Parameters
    ----------
    name : str
        A name in Python; that of the option has hyphens.
    default : float, int, str or None
        Without it; None where the format chooses by itself, and then there is a `kind`.
    meaning : str
        A sentence for the option's help.
    least, most : float
        The range of a number.
    unit : str
        Of a number: Hz, mm/min; `-` of a share, which may be typed as 25%.
    kind : type, optional
        float, int or str; by default that of the default. `object` is no option: only Python can
        give it.
    """

    name: str
    default: Any
    meaning: str
    least: float = -inf
    most: float = inf
    unit: str = ""
    kind: type | None = None

    def __post_init__(self) -> None:
        if not self.name.isidentifier() or self.name in (*_OPTIONS, "plant_file"):
            raise ValueError(
                f"setting {quoted(self.name)} has no free name in Python; give another"
            )
        if self.type_of_value not in (float, int, str, object):
            raise ValueError(
                f"setting {self.name} is {quoted(self.default)}; give a number or a text, or say "
                "its kind"
            )

    @property
    def type_of_value(self) -> type:
        """Whether it is a number, a whole number or a text."""
        return self.kind or type(self.default)

    @property
    def option(self) -> str:
        """The option of quietarm export."""
        return f"--{self.name.replace('_', '-')}"

    def check(self, value: Any) -> Any:
        """The value, a number as such; ValueError beyond the range."""
        kind = self.type_of_value
        if kind is object or (value is None and self.default is None):
            return value
        if kind is str:
            if not isinstance(value, str):
                raise ValueError(f"{self.name} is {quoted(value)}; give a text")
            return value
        if kind is int:
            least = -(10**9) if self.least == -inf else int(self.least)
            return whole(self.name, value, least, None if self.most == inf else int(self.most))
        number = finite(self.name, value, self.unit.strip("-"))
        if not self.least <= number <= self.most:
            least = f" from {self.least:g}" if self.least > -inf else ""
            most = f" up to {self.most:g}" if self.most < inf else ""
            raise ValueError(f"{self.name} is {number:g}; give a number{least}{most}")
        return number


class ExportFormat(ABC):
    """A format of files. A new one defines a name, endings and `content`.

    A class in a new file of `views/formats`, or beside a plant in its `--plant-file`, is known to
    `export_plan` and to every command that writes plans or fronts.

    Raises
    ------
    ValueError
        When a subclass leaves something out.
    """

    name: ClassVar[str]
    """What messages call it, and `--format`."""
    endings: ClassVar[tuple[str, ...]]
    """Of its files' names, in small letters; the first one is shown."""
    meaning: ClassVar[str]
    """What its files hold, as commands list it: a table, a film."""
    takes: ClassVar[tuple[str, ...]] = (PLAN,)
    """What it can write: plan, front, several of these, dataset."""
    settings: ClassVar[tuple[Setting, ...]] = ()
    """What it may be told. Other commands than export write with the defaults."""
    to_stdout: ClassVar[bool] = False
    """Whether it can go to standard output: a single text."""
    beside: ClassVar[tuple[str, ...]] = ()
    """Endings of the files that stand beside the one that is named."""
    pieces: ClassVar[str] = ""
    """What is counted while it is made, where that takes long: frames."""

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if "name" in vars(cls):
            _check_definition(cls)

    def content(self, plan: Plan, *args: Any, **settings: Any) -> Content:
        """What the file of a plan holds; the settings come by their names."""
        raise NotImplementedError

    def note(self, plan: Plan, *args: Any, **settings: Any) -> str:
        """What is said of the file beside that it was written; by default nothing."""
        return ""

    def export(self, answers: Answers, path: Path, report: Progress, **settings: Any) -> Exported:
        """Make all files: by default the one of a plan's `content`.

        Of several answers, or with several files, in place of `content`.

        Parameters
        ----------
        answers : mapping or sequence
            What it takes, perhaps by name.
        path : Path
            The file that was asked for; `-` is standard output.
        report : callable
            Takes how many `pieces` are done, of how many.
        **settings : Any
            All of its settings.
        """
        (plan,) = values_of(answers)
        content = self.content(plan, **settings)
        if not isinstance(content, str | bytes):
            raise ValueError(
                f"content of the format {self.name} returns {quoted(content)}; return text or bytes"
            )
        return Exported({path: content}, [self.note(plan, **settings)])

    def check_path(self, path: Path) -> None:
        """Refuse a file's name before the work, where the format has no use for it."""
        del path  # any will do

    def complete(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """All settings, as given or by default; ValueError of one that is not its own."""
        own = {setting.name: setting for setting in self.settings}
        for name in given:
            if name not in own:
                takers = [form.name for form in takers_of(name)]
                if takers:
                    raise ValueError(f"{name} is for {', '.join(takers)}, not for {self.name}")
                raise ValueError(unknown(f"setting of {self.name}", name, own))
        return {
            name: setting.check(given.get(name, setting.default)) for name, setting in own.items()
        }

    def make(
        self,
        answers: Answers,
        path: Path,
        given: Mapping[str, Any],
        report: Progress | None = None,
    ) -> Exported:
        """Make the files after checks of what is given; nothing is written yet."""
        self.refuse_others(values_of(answers))
        self.check_path(path)
        settings = self.complete(given)
        try:
            return self.export(answers, path, report or _say_nothing, **settings)
        except (ValueError, QuietarmError, OSError):
            raise
        except Exception as error:
            if ships(type(self)):
                raise
            raise failed_in(f"format {self.name}", type(self), error) from error

    def refuse_number(self, number: int) -> None:
        """Refuse several answers where it takes one."""
        if number > 1 and SEVERAL not in self.takes:
            raise ValueError(f"{self.name} is of one plan, and {number} are given; give one")

    def refuse_others(self, answers: Sequence[Any]) -> None:
        """Refuse answers that it does not take."""
        self.refuse_number(len(answers))
        if not answers:
            raise ValueError(f"no {self.takes[0]} is given; give one")
        for answer in answers:
            kind = PLAN if isinstance(answer, Plan) else FRONT if isinstance(answer, Front) else ""
            if (kind or DATASET) not in self.takes:
                what = kind or type(answer).__name__
                raise ValueError(
                    f"{self.name} is not of a {what}; give {', '.join(self.takes)}, or a file that "
                    f"ends in one of {endings_of(kind)}"
                )


def _say_nothing(done: int, total: int) -> None:
    """What takes the progress where nobody wants to know."""


def values_of(answers: Answers) -> Sequence[Any]:
    """Answers without what they are called."""
    return list(answers.values()) if isinstance(answers, Mapping) else answers


def known_formats() -> Mapping[str, ExportFormat]:
    """The formats by name: those of this folder, and of files that were loaded since.

    ValueError where one of the user's has an ending that is another's.
    """
    for module in iter_modules([str(Path(__file__).parent)]):
        import_module(f"{__package__}.{module.name}")
    formats = {name: kind() for name, kind in known(ExportFormat).items()}
    owners = dict[str, ExportFormat]()
    for form in formats.values():
        for ending in form.endings:
            other = owners.setdefault(ending, form)
            if other is not form:
                raise ValueError(
                    f"ending {ending} of {type(form).__name__} is that of the format {other.name}; "
                    f"give {type(form).__name__} another"
                )
    return formats


def formats_of(*taken: str) -> list[ExportFormat]:
    """The formats that take one of these: a plan, a front."""
    return [form for form in known_formats().values() if {*taken} & {*form.takes}]


def takers_of(setting: str) -> list[ExportFormat]:
    """The formats that have a setting of this name."""
    return [
        form for form in known_formats().values()
        if any(own.name == setting for own in form.settings)
    ]  # fmt: skip


def endings_of(*taken: str) -> str:
    """The endings of all formats, or of those that take something, as a message lists them."""
    formats = formats_of(*taken) if any(taken) else known_formats().values()
    return listed(ending for form in formats for ending in form.endings)


def format_of(path: Path) -> ExportFormat:
    """The format of a file by the ending of its name; ValueError where there is none."""
    ending = path.suffix.lower()
    for form in known_formats().values():
        if ending in form.endings:
            return form
        if ending in form.beside:
            instead = path.with_suffix(form.endings[0])
            raise ValueError(f"{path} is written beside its {form.meaning}; give {instead}")
    raise ValueError(
        f"{path} does not say in which form it is; end its name in one of {endings_of()}"
    )


def _check_definition(kind: type[ExportFormat]) -> None:
    """Refuse a class that is no format yet."""
    label = kind.__name__
    for entry, example in {"name": "'mine'", "endings": "('.nc',)", "meaning": "'G-code'"}.items():
        if not hasattr(kind, entry):
            raise ValueError(f"format {label} has no {entry}; give one, as {entry} = {example}")
    if not isinstance(kind.endings, tuple) or not kind.endings:
        raise ValueError(f"endings of {label} are {quoted(kind.endings)}; give them as ('.nc',)")
    for ending in (*kind.endings, *kind.beside):
        if not _is_ending(ending):
            raise ValueError(f"ending {quoted(ending)} of {label} is none; give one as '.nc'")
        if ending in _TAKEN_BY_COMMANDS:
            raise ValueError(f"ending {ending} of {label} is for other files; give another")
    for taken in kind.takes:
        if taken not in TAKEN:
            raise ValueError(unknown(f"answer that {label} takes", taken, TAKEN))
    names = [setting.name for setting in kind.settings]
    if len({*names}) < len(names):
        raise ValueError(f"{label} has a setting twice among {', '.join(names)}; give each once")
    if kind.content is ExportFormat.content and kind.export is ExportFormat.export:
        raise ValueError(f"format {label} writes nothing; define content(self, plan, ...)")


def _is_ending(text: object) -> bool:
    """Whether a text is the end of a file's name, with its point and in small letters."""
    return isinstance(text, str) and Path(f"a{text}").suffix == text == text.lower() != ""
