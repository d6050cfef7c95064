"""The planner's process, as the node sees it; it needs the standard library alone."""

import contextlib
import json
import os
import subprocess
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any

PLANNER = Path(__file__).with_name("planner.py")


class PlannerError(Exception):
    """The planner could not begin, or ended."""


class PlannerProcess:
    """A process of quietarm's Python, asked one message at a time.

    Parameters
    ----------
    python : str
        The interpreter in whose environment quietarm is installed.
    options : mapping
        The robot's file, and fields of `quietarm.studies.MessagePlanner`.
    environment : mapping, optional
        By default this process's, without the PYTHONPATH of ROS, whose packages are not quietarm's.

    Raises
    ------
    PlannerError
        When the interpreter does not start, has no quietarm, or the robot cannot be read.
    """

    def __init__(
        self,
        python: str,
        options: Mapping[str, Any],
        environment: Mapping[str, str] | None = None,
    ) -> None:
        if environment is None:
            environment = {
                name: value for name, value in os.environ.items() if name != "PYTHONPATH"
            }
        self._one_at_a_time = threading.Lock()
        try:
            self._process = subprocess.Popen(
                [python, str(PLANNER)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env=dict(environment),
                text=True,
                encoding="utf-8",
            )
        except OSError as error:
            raise PlannerError(
                f"quietarm_python is {python}, which does not start ({error}); give the "
                "interpreter of the environment with quietarm, such as ~/quietarm/bin/python"
            ) from None
        self.robot = self.ask(options)
        if "error" in self.robot:
            self.close()
            raise PlannerError(self.robot["error"])

    def ask(self, question: Mapping[str, Any]) -> dict[str, Any]:
        """Return the planner's answer, which may be an error.

        Raises
        ------
        PlannerError
            When the process has ended.
        """
        stdin, stdout = self._process.stdin, self._process.stdout
        assert stdin is not None
        assert stdout is not None
        with self._one_at_a_time:
            try:
                stdin.write(json.dumps(question) + "\n")
                stdin.flush()
                line = stdout.readline()
            except (OSError, ValueError):
                line = ""
        if not line:
            raise PlannerError(
                "the planner has ended; its last words are above, as that quietarm is not "
                "installed in the environment of quietarm_python"
            )
        return json.loads(line)

    def close(self) -> None:
        """End the process."""
        with self._one_at_a_time:
            if self._process.stdin is not None and not self._process.stdin.closed:
                with contextlib.suppress(OSError):  # it has ended before
                    self._process.stdin.close()
            try:
                self._process.wait(timeout=5)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
            if self._process.stdout is not None:
                self._process.stdout.close()
