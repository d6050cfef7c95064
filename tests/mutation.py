"""Mutation testing: what share of small faults in the equations do the tests notice?

    python tests/mutation.py                                      300 mutants, always the same
    python tests/mutation.py --sample 0                           every mutant
    python tests/mutation.py --only ocp/simulation/objective.py   of one module (may be repeated)

A mutant is one module with one operator or number changed, by cosmic-ray's operators. Each runs in
a process of its own, which sees the changed source in place of the file: nothing is written. The
quick tests run until the first one fails; a mutant that all of them pass has survived, and is
printed.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib.abc
import importlib.util
import os
import random
import re
import resource
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

# Imported before the processes part, so that each need not do it again.
import casadi  # noqa: F401
import cosmic_ray.plugins
import hypothesis  # noqa: F401
import numpy  # noqa: F401
import pytest
import scipy.integrate
import scipy.optimize  # noqa: F401
from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))  # this checkout's packages, also where quietarm is installed
QUICK = [
    f"ocp/simulation/test_{name}.py"
    for name in ("free_vibration", "energy", "rollout", "closed_forms", "third_opinion")
]
"""Those of the simulation that are done in seconds: the first that fails ends the tests."""
SLOW = ["ocp/solvers/test_batch.py", "ocp/simulation/test_derivatives_of_the_rollout.py"]
TESTS = {
    "models/plant.py": [
        "models/test_plants.py",
        "models/test_contract.py",
        "ocp/test_several_joints.py",
        "machine/identify/test_parameter_kinds.py",
        "models",
        "ocp/test_task.py",
    ],
    "models/single_link.py": ["models"],
    "models/dual_link.py": ["models"],
    "models/arm_on_flexible_link.py": ["models"],
    "ocp/simulation/collocation.py": [*QUICK, *SLOW, "machine/identify/test_identify.py"],
    "ocp/simulation/objective.py": [
        *QUICK,
        "ocp/test_judged_motion.py",
        "ocp/test_energies.py",
        *SLOW,
    ],
    "ocp/profiles/joint_profile.py": ["ocp/profiles", *QUICK, "ocp/planning/test_solver.py"],
    "ocp/profiles/check_profile.py": ["ocp/profiles"],
    "ocp/profiles/differentiate.py": ["ocp/profiles", *QUICK],
    "ocp/profiles/cycloid.py": [
        "ocp/profiles/test_polynomial.py",
        "ocp/profiles/test_own.py",
        "ocp/profiles/test_shaped_inputs.py",
    ],
    "ocp/simulation/free_vibration.py": [*QUICK, "ocp/planning/test_shaping.py"],
    "ocp/simulation/rollout.py": [
        *QUICK,
        "metaheuristics/evaluation/test_population.py",
        *SLOW,
        "ocp/solvers/test_both_solvers.py",
    ],
    "ocp/judged_motion.py": [
        *QUICK,
        "ocp/simulation/test_free_motions.py",
        "ocp/test_judged_motion.py",
        "ocp/robustness/test_uncertain.py",
    ],
}
"""The modules to change, and the tests that should notice."""

OPERATORS = re.compile(
    r"core/(AddNot|NumberReplacer|ReplaceAndWithOr|ReplaceOrWithAnd|ReplaceTrueWithFalse"
    r"|ReplaceFalseWithTrue|ReplaceUnaryOperator_(Delete|USub_UAdd).*|ZeroIterationForLoop"
    r"|ReplaceBreakWithContinue|ReplaceContinueWithBreak|ExceptionReplacer"
    r"|ReplaceBinaryOperator_(Add_Sub|Sub_Add|Mul_Div|Div_Mul|Pow_Mul|FloorDiv_Mul|Mod_Mul)"
    r"|ReplaceComparisonOperator_(Eq_NotEq|NotEq_Eq|Lt_LtE|LtE_Lt|Gt_GtE|GtE_Gt"
    r"|Lt_GtE|LtE_Gt|Gt_LtE|GtE_Lt|Is_IsNot|In_NotIn))"
)
"""One or two changes of each operator; the others (a product into a shift) no test would miss."""

NO_FAULT = re.compile(r"^@lru_cache|max_num_steps")
"""Lines whose numbers change only how long something takes."""

CPU_SECONDS, MEMORY = 150, 4 * 2**30
"""Processor time and bytes after which a mutant is stopped, and so noticed."""


@dataclass(frozen=True)
class Mutant:
    """One change of one module."""

    module: str
    operator: str
    occurrence: int
    line: int

    def source(self) -> str:
        """The module's changed text."""
        operator = cosmic_ray.plugins.get_operator(self.operator)()
        changed = mutate_code((ROOT / self.module).read_text(), operator, self.occurrence)
        assert changed is not None
        return changed

    def __str__(self) -> str:
        now, before = self.source().splitlines(), (ROOT / self.module).read_text().splitlines()
        changed = [(a, b) for a, b in zip(before, now, strict=False) if a != b]
        lines = changed[0] if changed else (before[self.line - 1], "?")
        return f"{self.module}:{self.line}\n  - {lines[0].strip()}\n  + {lines[1].strip()}"


def mutants(module: str) -> Iterator[Mutant]:
    """Every mutant of a module, in a fixed order."""
    text = (ROOT / module).read_text()
    nodes, lines = list(ast_nodes(get_ast(text))), text.splitlines()
    for name in sorted(filter(OPERATORS.fullmatch, cosmic_ray.plugins.operator_names())):
        operator = cosmic_ray.plugins.get_operator(name)()
        starts = (start for node in nodes for start, _ in operator.mutation_positions(node))
        for occurrence, (line, _) in enumerate(starts):
            if not NO_FAULT.search(lines[line - 1].strip()):
                yield Mutant(module, name, occurrence, line)


class _Changed(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Import one module from a changed source."""

    def __init__(self, module: str, source: str) -> None:
        self.name = "quietarm." + module.removesuffix(".py").replace("/", ".")
        self.file = str(ROOT / module)
        self.source = source

    def find_spec(self, fullname, path=None, target=None):
        if fullname != self.name:
            return None
        return importlib.util.spec_from_file_location(fullname, self.file, loader=self)

    def exec_module(self, module) -> None:
        exec(compile(self.source, self.file, "exec"), module.__dict__)


def in_a_process(work: Callable[[], int]) -> int:
    """Start work in a process of its own that says nothing; its id."""
    pid = os.fork()
    if pid:
        return pid
    code = 1
    with contextlib.suppress(BaseException):
        resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        silent = os.open(os.devnull, os.O_RDWR)
        for stream in range(3):
            os.dup2(silent, stream)
        code = work()
    os._exit(code)


def tested(module: str, source: str) -> int:
    """Return pytest's status of a module's tests, with its source replaced."""
    sys.meta_path.insert(0, _Changed(module, source))
    os.chdir(ROOT)
    quiet = ["-W", "ignore::pytest.PytestAssertRewriteWarning"]  # hypothesis is here already
    options = ["-x", "-q", "-n0", "-m", "not slow", "-p", "no:cacheprovider", *quiet]
    options.append("--hypothesis-profile=mutation")
    return int(pytest.main([*options, *(f"tests/{name}" for name in TESTS[module])]))


def survivors(sample: list[Mutant], workers: int) -> Iterator[Mutant]:
    """The mutants that all their tests pass, as they are found."""
    waiting, running = list(reversed(sample)), dict[int, Mutant]()
    while waiting or running:
        while waiting and len(running) < workers:
            mutant = waiting.pop()
            source = mutant.source()
            running[in_a_process(lambda m=mutant, s=source: tested(m.module, s))] = mutant
        pid, status = os.wait()
        mutant = running.pop(pid)
        if status == 0:
            yield mutant


def main() -> None:
    """Print the survivors and the score of each module."""
    parser = argparse.ArgumentParser(description="Mutation testing of the equations.")
    parser.add_argument("--sample", type=int, default=300, help="how many mutants; 0: every one")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", action="append", choices=list(TESTS))
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    given = parser.parse_args()

    modules = given.only or list(TESTS)
    for module in modules:
        text = (ROOT / module).read_text()
        pid = in_a_process(lambda m=module, s=text: tested(m, s))
        if os.waitpid(pid, 0)[1]:
            sys.exit(f"the tests of {module} fail without any change")
    every = [mutant for module in modules for mutant in mutants(module)]
    sample = random.Random(given.seed).sample(every, len(every))[: given.sample or None]
    print(f"{len(sample)} of {len(every)} mutants, seed {given.seed}", flush=True)
    left = Counter[str]()
    for mutant in survivors(sample, given.workers):
        left[mutant.module] += 1
        print(f"survived: {mutant}", flush=True)
    drawn = Counter(mutant.module for mutant in sample)
    for module, number in sorted(drawn.items()):
        print(f"{module:34} {number - left[module]:4} of {number:4} noticed")
    total = len(sample)
    print(f"{'score':34} {total - left.total():4} of {total:4}: {1 - left.total() / total:.1%}")


if __name__ == "__main__":
    main()
