"""The base class of export formats, their settings, and the lookup by name and by ending."""

from __future__ import annotations

from abc import ABC
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from math import inf
from pathlib import Path
from pkgutil import iter_modules
from typing import Any, ClassVar, NamedTuple

from quietarm.ocp import Front, Plan, QuietarmError
from quietarm.ocp.checks import (
    failed_in,
    finite,
    forgotten_if_refused,
    joined,
    known,
    listed,
    object_of,
    quoted,
    ships,
    unknown,
    whole,
    with_article,
)
from quietarm.ocp.told_progress import Progress

PLAN = "plan"
FRONT = "front"
SEVERAL = "several"
DATASET = "dataset"
TAKEN = (PLAN, FRONT, SEVERAL, DATASET)
"""Kinds of answers: a plan, a front, several of them at once, the moves of a sweep."""
_NOUNS = {PLAN: "plan", FRONT: "front", DATASET: "dataset of a sweep"}
_TAKEN_BY_COMMANDS = (".json", ".png", ".pdf", ".svg", ".zarr", ".tex", ".txt")
"""Endings that commands use for other files."""
_OPTIONS = ("output", "format", "form", "plans", "plan", "path", "report", "quiet", "help")
"""Names that `quietarm export` and `export_plan` use themselves."""

Content = str | bytes
Answers = Mapping[str, Any] | Sequence[Any]
"""Plans, fronts, or the moves of a sweep; a mapping gives their labels."""


class Exported(NamedTuple):
    """The content of every file, and notes for the user. All files are written, or none."""

    files: Mapping[Path, Content]
    notes: Sequence[str] = ()


@dataclass(frozen=True)
class ExportSetting:
    """A setting of a format: `rate=500` in `export_plan`, `--rate 500` in quietarm export.

    Parameters
    ----------
    name : str
        Its name in Python. The option has hyphens in place of underscores.
    default : float, int, str or None
        The value that is used if none is given. With None the format chooses, and `kind` is needed.
    meaning : str
        A sentence for the help of the option.
    least, most : float
        The range of a number.
    unit : str
        The unit of a number, such as Hz or mm/min. ``-`` is a share, which may be typed as 25%.
    kind : type, optional
        float, int or str; by default the type of `default`. A setting of the kind `object` can be
        given in Python only.

    Raises
    ------
    ValueError
        If the name is not free, or the default is out of range.
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
        self.check(self.default)

    @property
    def type_of_value(self) -> type:
        """The type of its values: float, int, str or object."""
        return self.kind or type(self.default)

    @property
    def option(self) -> str:
        """Name of the setting's option on the command line."""
        return f"--{self.name.replace('_', '-')}"

    def check(self, value: Any) -> Any:
        """Return a value of its type; ValueError if it is none, or out of range."""
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
        unit = self.unit.strip("-")
        number = finite(self.name, value, unit)
        if not self.least <= number <= self.most:
            least = f" from {self.least:g}" if self.least > -inf else ""
            most = f" up to {self.most:g}" if self.most < inf else ""
            stated = f"{number:g} {unit}".strip()
            wanted = f"a number{least}{most} {unit}".strip()
            raise ValueError(f"{self.name} is {stated}; give {wanted}")
        return number


class ExportFormat(ABC):
    """An export format. A new one is a class with a `name`, `endings`, a `meaning` and `content`.

    A class in a new file of `views/formats`, or in a user's `--plant-file`, is known to
    `export_plan` and to every command that writes plans or fronts.

    Raises
    ------
    ValueError
        If a subclass is incomplete; the message says what to add.
    """

    name: ClassVar[str]
    """The name in messages and for `--format`."""
    endings: ClassVar[tuple[str, ...]]
    """Endings of its files, in small letters; lists show the first one."""
    meaning: ClassVar[str]
    """What its files contain, for lists of commands: a table, a film."""
    takes: ClassVar[tuple[str, ...]] = (PLAN,)
    """What it can write: plan, front, several, dataset."""
    settings: ClassVar[tuple[ExportSetting, ...]] = ()
    """Its settings. Commands other than export use the defaults."""
    to_stdout: ClassVar[bool] = False
    """True if it is a single text, which can go to standard output."""
    beside: ClassVar[tuple[str, ...]] = ()
    """Endings of further files that are written beside the named one."""
    of_the_load: ClassVar[bool] = False
    """True if it has the load's path where a plant has a drive, not the set points through it."""
    pieces: ClassVar[str] = ""
    """The unit of progress if writing takes long, such as frames."""

    @property
    def taken(self) -> str:
        """Answers that the format takes, in words: a plan, plans or fronts."""
        nouns = [_NOUNS[kind] for kind in self.takes if kind != SEVERAL]
        if SEVERAL in self.takes:
            return joined([f"{noun}s" for noun in nouns], "or")
        return joined(map(with_article, nouns), "or")

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if "name" in vars(cls):
            with forgotten_if_refused(cls):
                _check_definition(cls)

    def content(self, plan: Plan, *args: Any, **settings: Any) -> Content:
        """Return the content of a plan's file; settings come as keyword arguments."""
        raise NotImplementedError

    def note(self, plan: Plan, *args: Any, **settings: Any) -> str:
        """Return a line for the user about the file; by default an empty one."""
        return ""

    def export(self, answers: Answers, path: Path, report: Progress, **settings: Any) -> Exported:
        """Make all files; by default one file with the `content` of one answer.

        Override it for several answers or several files.

        Parameters
        ----------
        answers : mapping or sequence
            The answers; a mapping gives their labels.
        path : Path
            The file that was asked for; ``-`` is standard output.
        report : callable
            Call it with the number of `pieces` done and their total.
        **settings : Any
            Every setting of the format.

        Returns
        -------
        Exported or mapping
            The content of every file by its path.
        """
        (plan,) = values_of(answers)
        content = self.content(plan, **settings)
        if not isinstance(content, str | bytes):
            raise ValueError(
                f"content of the format {self.name} returns {quoted(content)}; return text or bytes"
            )
        return Exported({path: content}, [self.note(plan, **settings)])

    def check_path(self, path: Path) -> None:
        """Raise ValueError for a file name that the format cannot use, before any work."""
        del path  # any will do

    def complete(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """Return all settings, given or default; ValueError for one that it does not have."""
        own = {setting.name: setting for setting in self.settings}
        for name in given:
            if name not in own:
                takers = [form.name for form in takers_of(name)]
                if takers:
                    raise ValueError(f"{name} is for {joined(takers)}, not for {self.name}")
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
        """Check answers, path and settings, and make the files; nothing is written."""
        self.refuse_others(values_of(answers))
        self.check_path(path)
        settings = self.complete(given)
        try:
            made: Any = self.export(answers, path, report or _say_nothing, **settings)
            return made if isinstance(made, Exported) else Exported({**made})
        except (ValueError, QuietarmError, OSError):
            raise
        except Exception as error:
            if ships(type(self)):
                raise
            raise failed_in(f"format {self.name}", type(self), error) from error

    def refuse_number(self, number: int) -> None:
        """Raise ValueError for several answers if it takes one."""
        if number > 1 and SEVERAL not in self.takes:
            raise ValueError(f"{self.name} takes {self.taken}, and {number} are given; give one")

    def refuse_others(self, answers: Sequence[Any]) -> None:
        """Raise ValueError for answers that it does not take."""
        self.refuse_number(len(answers))
        if not answers:
            raise ValueError(f"nothing is given; {self.name} takes {self.taken}: give one")
        for answer in answers:
            kind = PLAN if isinstance(answer, Plan) else FRONT if isinstance(answer, Front) else ""
            if (kind or DATASET) not in self.takes:
                what = with_article(kind or type(answer).__name__)
                raise ValueError(
                    f"{self.name} takes {self.taken}, and {what} is given; give a file that ends "
                    f"in one of {endings_of(kind)}"
                )


def _say_nothing(done: int, total: int) -> None:
    """Ignore progress."""


def values_of(answers: Answers) -> Sequence[Any]:
    """Return the answers without their labels."""
    return list(answers.values()) if isinstance(answers, Mapping) else answers


def known_formats() -> Mapping[str, ExportFormat]:
    """Return all formats by name: those of this folder, then those of the user's files.

    ValueError if a user's format has an ending of another one.
    """
    _load_shipped()
    formats: dict[str, ExportFormat] = {
        name: object_of(kind) for name, kind in known(ExportFormat).items()
    }
    # whatever was loaded first, quietarm's own stand first, by name
    formats = dict(sorted(formats.items(), key=lambda entry: (not ships(type(entry[1])), entry[0])))
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


@cache
def _load_shipped() -> None:
    """Import every file of this folder, once: its formats are then known."""
    for module in iter_modules([str(Path(__file__).parent)]):
        import_module(f"{__package__}.{module.name}")


def formats_of(*taken: str) -> list[ExportFormat]:
    """Return the formats that take one of these kinds, such as plan or front."""
    return [form for form in known_formats().values() if {*taken} & {*form.takes}]


def takers_of(setting: str) -> list[ExportFormat]:
    """Return the formats that have a setting of this name."""
    return [
        form for form in known_formats().values()
        if any(own.name == setting for own in form.settings)
    ]  # fmt: skip


def endings_of(*taken: str) -> str:
    """List the endings of all formats, or of those that take a kind, for a message."""
    formats = formats_of(*taken) if any(taken) else known_formats().values()
    return listed(ending for form in formats for ending in form.endings)


def format_of(path: Path) -> ExportFormat:
    """Return the format of a file by its ending; ValueError if no format has it."""
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
    """Raise ValueError for a class that is not a complete format."""
    label = kind.__name__
    for entry, example in {"name": "'mine'", "endings": "('.nc',)", "meaning": "'G-code'"}.items():
        if not hasattr(kind, entry):
            raise ValueError(
                f"format {label} has no {entry}; give one, such as {entry} = {example}"
            )
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
    """Return True for the ending of a file name, with its dot and in small letters."""
    return isinstance(text, str) and Path(f"a{text}").suffix == text == text.lower() != ""
