"""Runs a function block of Structured Text: as much of IEC 61131-3 as quietarm writes, no more."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

MATIEC = shutil.which("iec2c")
"""The compiler of matiec from Structured Text to C; IEC2C_LIBRARY is its folder `lib`."""
needs_matiec = pytest.mark.skipif(
    MATIEC is None or "IEC2C_LIBRARY" not in os.environ, reason="there is no iec2c of matiec"
)
TOKEN = re.compile(
    r"\(\*.*?\*\)|\s+|(?P<number>\d+\.\d+(?:E[+-]?\d+)?|\d+)|(?P<word>[A-Za-z]\w*)"
    r"|(?P<sign>:=|<=|>=|<>|\.\.|[-+*/<>=()\[\];:,])",
    re.S,
)
KEYWORDS = """
    abs acos action add and any array asin at atan bool by byte case concat configuration constant
    continue cos ctd ctu date delete dint div do dword else elsif en end_for end_if eno eq exit
    exp expt f_edge f_trig false find for from function function_block ge gt if initial insert int
    interval le left len limit lint ln log lreal lt lword max mid min mod move mul mux ne not of
    on or pt program r_edge r_trig real repeat replace resource retain return right rol ror rs sel
    shl shr sin single sint sqrt sr step string struct sub tan task then time to tod tof ton tp
    transition true trunc type udint uint ulint until usint var var_input var_output while with
    word wstring xor et q in
"""
RESERVED = {*KEYWORDS.split()}
"""Words that no variable may have: keywords, standard functions and blocks."""
FUNCTIONS = {
    "sin": np.sin, "cos": np.cos, "tan": np.tan, "asin": np.arcsin, "acos": np.arccos,
    "atan": np.arctan, "exp": np.exp, "ln": np.log, "sqrt": np.sqrt, "abs": abs, "min": min,
    "max": max, "expt": lambda base, power: base**power,
    "sel": lambda chosen, otherwise, value: value if chosen else otherwise,
}  # fmt: skip
ORDER = [("or", "xor"), ("and",), ("=", "<>"), ("<", ">", "<=", ">="), ("+", "-"), ("*", "/")]
OPERATIONS = {
    "or": lambda a, b: a or b, "xor": lambda a, b: a != b, "and": lambda a, b: a and b,
    "=": lambda a, b: a == b, "<>": lambda a, b: a != b, "<": lambda a, b: a < b,
    ">": lambda a, b: a > b, "<=": lambda a, b: a <= b, ">=": lambda a, b: a >= b,
    "+": lambda a, b: a + b, "-": lambda a, b: a - b, "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
}  # fmt: skip


class Block:
    """A function block that keeps its variables between its calls."""

    def __init__(self, text):
        self.tokens = list(_tokens(text))
        self.place = 0
        self.kinds = {}
        self.values = {}
        self.groups = {"input": [], "output": [], "constant": [], "": []}
        self._expect("function_block")
        self.name = self._word()
        while self._next() in ("var", "var_input", "var_output"):
            self._variables()
        self.body = self._statements("end_function_block")
        self._expect("end_function_block")
        assert self.place == len(self.tokens), "there is more than one block"

    def __call__(self, **inputs):
        """The outputs of a call, by their names as the source spells them."""
        for name, value in inputs.items():
            assert name.lower() in self.groups["input"], name
            self._set(name.lower(), None, self._typed(self.kinds[name.lower()], value))
        self._run(self.body)
        return {self.spelled[name]: self.values[name] for name in self.groups["output"]}

    # reading

    def _next(self):
        return self.tokens[self.place][1].lower() if self.place < len(self.tokens) else ""

    def _take(self):
        self.place += 1
        return self.tokens[self.place - 1]

    def _expect(self, text):
        _, found = self._take()
        assert found.lower() == text, f"{found!r} where {text!r} is due"

    def _word(self):
        kind, text = self._take()
        assert kind == "word", text
        assert text.lower() not in RESERVED, f"{text} is reserved"
        assert not re.search("__|_$", text), f"{text} is no identifier"
        return text

    def _accepts(self, *texts):
        return self._take()[1].lower() if self._next() in texts else ""

    def _variables(self):
        group = self._take()[1].lower().removeprefix("var").removeprefix("_")
        group = "constant" if self._accepts("constant") else group
        self.spelled = getattr(self, "spelled", {})
        while not self._accepts("end_var"):
            name = self._word()
            self._expect(":")
            length = self._length() if self._accepts("array") else None
            kind = self._take()[1].lower()
            assert kind in ("bool", "real", "lreal"), kind
            least, most = length or (0, 0)
            start = [self._typed(kind, 0)] * (most - least + 1)
            if self._accepts(":="):
                start = self._constants(kind, length is not None)
                assert len(start) == most - least + 1
            self._expect(";")
            key = name.lower()
            assert key not in self.kinds, f"{name} is declared twice"
            self.spelled[key] = name
            self.kinds[key] = kind
            self.groups[group].append(key)
            self.values[key] = dict(enumerate(start, least)) if length else start[0]

    def _length(self):
        self._expect("[")
        least = int(self._take()[1])
        self._expect("..")
        most = int(self._take()[1])
        self._expect("]")
        self._expect("of")
        return least, most

    def _constants(self, kind, array):
        if array:
            self._expect("[")
        values = [self._constant(kind)]
        while array and self._accepts(","):
            values.append(self._constant(kind))
        if array:
            self._expect("]")
        return values

    def _constant(self, kind):
        sign = -1 if self._accepts("-") else 1
        what, text = self._take()
        assert what == "number", text
        assert "." in text, f"{text} is no real number"
        return self._typed(kind, sign * float(text))

    def _statements(self, *ends):
        found = []
        while self._next() not in ends:
            found.append(self._statement())
        return found

    def _statement(self):
        if self._accepts("if"):
            return self._branches()
        target = self._variable()
        assert target[1] not in self.groups["constant"], f"{target[1]} is constant"
        self._expect(":=")
        value = self._expression()
        self._expect(";")
        return ("set", target, value)

    def _branches(self):
        branches = []
        ends = ("elsif", "else", "end_if")
        while True:
            condition = self._expression()
            self._expect("then")
            branches.append((condition, self._statements(*ends)))
            if not self._accepts("elsif"):
                break
        otherwise = self._statements("end_if") if self._accepts("else") else []
        self._expect("end_if")
        self._expect(";")
        return ("if", branches, otherwise)

    def _variable(self):
        name = self._word().lower()
        assert name in self.kinds, f"{name} is not declared"
        index = None
        if self._accepts("["):
            index = int(self._take()[1])
            self._expect("]")
        assert (index is not None) == isinstance(self.values[name], dict), name
        return ("variable", name, index)

    def _expression(self, level=0):
        if level == len(ORDER):
            return self._factor()
        left = self._expression(level + 1)
        while sign := self._accepts(*ORDER[level]):
            left = ("binary", sign, left, self._expression(level + 1))
        return left

    def _factor(self):
        if self._accepts("-"):
            return ("minus", self._factor())
        if self._accepts("not"):
            return ("not", self._factor())
        if self._accepts("("):
            inner = self._expression()
            self._expect(")")
            return inner
        if self._accepts("true", "false"):
            return ("value", self.tokens[self.place - 1][1].lower() == "true")
        kind, text = self.tokens[self.place]
        if kind == "number":
            self._take()
            assert "." in text, f"{text} is no real number"
            return ("number", float(text))
        if text.lower() in FUNCTIONS:
            self._take()
            self._expect("(")
            given = [self._expression()]
            while self._accepts(","):
                given.append(self._expression())
            self._expect(")")
            return ("call", text.lower(), given)
        return self._variable()

    # running

    def _run(self, statements):
        for kind, *rest in statements:
            if kind == "set":
                (_, name, index), value = rest
                found = self._evaluate(value)
                is_bool = isinstance(found, bool | np.bool_)
                assert is_bool == (self.kinds[name] == "bool"), f"{name} has another type"
                self._set(name, index, found)
                continue
            branches, otherwise = rest
            for condition, inner in branches:
                if self._evaluate(condition):
                    self._run(inner)
                    break
            else:
                self._run(otherwise)

    def _set(self, name, index, value):
        if index is None:
            self.values[name] = value
        else:
            assert index in self.values[name], f"{name}[{index}] is beyond the array"
            self.values[name] = {**self.values[name], index: value}

    def _evaluate(self, node):
        kind, *rest = node
        match kind:
            case "value":
                return rest[0]
            case "number":
                return self._typed(self._real(), rest[0])
            case "variable":
                name, index = rest
                return self.values[name] if index is None else self.values[name][index]
            case "minus":
                return -self._evaluate(rest[0])
            case "not":
                return not self._evaluate(rest[0])
            case "call":
                return FUNCTIONS[rest[0]](*map(self._evaluate, rest[1]))
        sign, left, right = rest
        return OPERATIONS[sign](self._evaluate(left), self._evaluate(right))

    def _real(self):
        (kind,) = {*self.kinds.values()} - {"bool"}
        return kind

    @staticmethod
    def _typed(kind, value):
        return {"bool": bool, "real": np.float32, "lreal": np.float64}[kind](value)


def _tokens(text):
    place = 0
    while place < len(text):
        match = TOKEN.match(text, place)
        assert match, f"no token at {text[place : place + 20]!r}"
        place = match.end()
        if match.lastgroup:
            yield match.lastgroup, match[0]


MAIN = """
#include <stdio.h>
#include "iec_std_lib.h"
#include "POUS.h"
TIME __CURRENT_TIME;
BOOL __DEBUG;
#include "POUS.c"
int main(void)
{
    static %(block)s block;
    double step;
    int execute;

    %(block)s_init__(&block, 0);
    while (scanf("%%d %%lf", &execute, &step) == 2) {
        block.EXECUTE.value = execute;
        block.TIMESTEP.value = step;
        %(block)s_body__(&block);
        printf("%%d %%d %%d %(form)s\\n", block.BUSY.value, block.DONE.value, block.ERROR.value,
               %(values)s);
    }
    return 0;
}
"""


def run_by_matiec(source, calls, size=1):
    """Busy, Done, Error, positions, velocities and accelerations of calls, compiled by matiec."""
    library = Path(os.environ["IEC2C_LIBRARY"])
    folder = source.parent
    line = [MATIEC, "-I", library, "-T", folder, source]
    subprocess.run(line, check=True, capture_output=True, cwd=folder)
    places = [""] if size == 1 else [f".table[{k}]" for k in range(size)]
    names = ("POSITION", "VELOCITY", "ACCELERATION")
    values = [f"(double)block.{name}.value{place}" for name in names for place in places]
    form = " ".join(["%.17g"] * len(values))
    block = Block(source.read_text()).name.upper()
    text = MAIN % {"block": block, "form": form, "values": ", ".join(values)}
    (folder / "main.c").write_text(text)
    compiler = ["cc", "-std=gnu99", "-O1", "-w", "-I", library / "C", "-I", folder]
    compiled = [*compiler, "main.c", "-o", "run", "-lm"]
    subprocess.run(compiled, check=True, capture_output=True, cwd=folder)
    given = "".join(f"{execute:d} {step!r}\n" for execute, step in calls)
    run = subprocess.run([folder / "run"], input=given, check=True, capture_output=True, text=True)
    return np.array([[float(cell) for cell in row.split()] for row in run.stdout.splitlines()])


def as_row(outputs):
    """Return the row of a call of a `Block`."""
    row = [float(outputs[name]) for name in ("Busy", "Done", "Error")]
    for name in ("Position", "Velocity", "Acceleration"):
        value = outputs[name]
        row += map(float, value.values()) if isinstance(value, dict) else [float(value)]
    return row
