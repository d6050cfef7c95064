"""While the command is being loaded, a third of a second: Ctrl-C, and files that are in the way.

Nothing is imported here that Python has not loaded by itself: so a Ctrl-C during an import ends in
one line, and so does a file of the user's with the name of a module of Python's.
"""

import os
import sys

TYPE_CHECKING = False  # that of typing, which is not loaded here
if TYPE_CHECKING:
    import signal
    from types import FrameType, TracebackType
    from typing import Any
else:
    import _signal as signal  # as signal, without the enum that it imports

_COMMANDS = ("quietarm", "-m")
"""Names of the running program at the time that this is loaded, where it is the command:
`python -m quietarm` has not found its file yet."""
_OURS = ("models", "ocp", "metaheuristics", "studies")
_NEEDED = ("casadi", "click", "dask", "distributed", "matplotlib", "msgspec", "numpy", "pymoo",
           "rich", "scipy")  # fmt: skip


def end_in_one_line() -> None:
    """Let Ctrl-C and SIGTERM end the command in one line until `ready`; do nothing elsewhere.

    So does a file that takes the place of a package that is loaded.
    """
    program = os.path.basename(next(iter(sys.argv), ""))
    if os.path.splitext(program)[0] in _COMMANDS:
        for number in (signal.SIGINT, signal.SIGTERM):
            if signal.getsignal(number) in (signal.default_int_handler, signal.SIG_DFL):
                signal.signal(number, _end)
        sys.excepthook = _name_what_is_in_the_way


def ready() -> bool:
    """Leave signals to the command, which can handle them now; whether they were handled here."""
    was = signal.getsignal(signal.SIGINT) is _end
    for number, usual in (
        (signal.SIGINT, signal.default_int_handler),
        (signal.SIGTERM, signal.SIG_DFL),
    ):
        if signal.getsignal(number) is _end:
            signal.signal(number, usual)
    if sys.excepthook is _name_what_is_in_the_way:
        sys.excepthook = sys.__excepthook__
    return was


def in_the_way(error: BaseException) -> str | None:
    """What to say of a user's file that takes the place of a package; None where there is none.

    Parameters
    ----------
    error : BaseException
        What went wrong. A file that has the name of a module of Python's is told of only where it
        was loaded, or failed: many folders have a harmless one.
    """
    # as importlib.machinery has it, which imports modules that may be in the way
    finders = (one for one in sys.meta_path if getattr(one, "__name__", "") == "PathFinder")
    finder: Any = next(finders)
    # Python's own first: they are needed to look for the others
    for package in (*sorted(sys.stdlib_module_names), *_OURS, *_NEEDED):
        spec, home = finder.find_spec(package), _home(package)
        if spec is None or spec.origin is None or home is None:
            continue
        if os.path.realpath(spec.origin).startswith(os.path.join(home, "")):
            continue
        if package not in sys.stdlib_module_names or _ran(package, spec.origin, error):
            return (
                f"{spec.origin} takes the place of the package {package!r}; rename that file, or "
                "take its folder out of PYTHONPATH"
            )
    return None


def _ran(module: str, origin: str, error: BaseException) -> bool:
    """Whether a module was loaded from a file, or an error came from there."""
    frames, trace = [getattr(error, "filename", None)], error.__traceback__
    while trace is not None:
        frames.append(trace.tb_frame.f_code.co_filename)
        trace = trace.tb_next
    return origin in (*frames, getattr(sys.modules.get(module), "__file__", None))


def _home(package: str) -> str | None:
    """The folder that a package is installed in; None where it is not."""
    if package in _OURS:
        return os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
    if package in sys.stdlib_module_names:
        return os.path.realpath(sys.base_prefix)
    from importlib.metadata import PackageNotFoundError, distribution  # only after a failure

    try:
        return os.path.realpath(str(distribution(package).locate_file("")))
    except PackageNotFoundError:
        return None


def _end(number: int, frame: "FrameType | None") -> None:
    # An exception would pass through what is half loaded, and be shown with its traceback.
    os.write(2, b"quietarm: interrupted; nothing was written\n")
    os._exit(1)


def _name_what_is_in_the_way(
    kind: type[BaseException], error: BaseException, trace: "TracebackType | None"
) -> None:
    told = in_the_way(error) if issubclass(kind, Exception) else None
    if told is None:
        sys.__excepthook__(kind, error, trace)
    else:
        print(f"quietarm: {told}", file=sys.stderr)
