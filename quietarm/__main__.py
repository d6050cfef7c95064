"""The command, as `quietarm` and `python -m quietarm`: signals are handled before all else.

Nothing is imported here but what handles them; numpy and the commands follow in `main`.
"""

import signal
import sys
from contextlib import suppress
from types import FrameType

from quietarm.interrupts import INTERRUPTED, as_command, exit_status_of


def main() -> None:
    """Run the command and end the process with its status; what ends a process acts as Ctrl-C."""
    sys.exit(as_command(_run, _say_interrupted, _stop, _stopping()))


def _run() -> int:
    try:
        from quietarm.studies.cli.application import run_as_process
    except ModuleNotFoundError as error:
        if (error.name or "quietarm").partition(".")[0] == "quietarm":
            raise
        print(
            f"quietarm: the command needs {error.name}, and this is a light installation of the "
            "problems; install quietarm with all that it needs",
            file=sys.stderr,
        )
        return 2
    return run_as_process()


def _stopping() -> list[int]:
    """The signals that stop the command, unless they are ignored, as after `nohup`."""
    standing = {"SIGINT": signal.default_int_handler}
    standing |= dict.fromkeys(("SIGTERM", "SIGHUP"), signal.SIG_DFL)
    numbers = {number.name: number for number in signal.Signals}
    return [
        numbers[name]
        for name, handler in standing.items()
        if name in numbers and signal.getsignal(numbers[name]) is handler
    ]


def _stop(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt(number)


def _say_interrupted(stop: KeyboardInterrupt) -> int:
    with suppress(OSError):  # the reader may be gone, too
        sys.stdout.flush()
    with suppress(OSError):
        print(f"quietarm: {INTERRUPTED}", file=sys.stderr, flush=True)
    return exit_status_of(stop)


if __name__ == "__main__":  # not in the workers of a search
    main()
