"""Exported C, compiled with all warnings as errors."""

import ctypes
import shutil
import subprocess

import pytest

COMPILER = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="there is no C compiler")
STRICT = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O2", "-shared", "-fPIC"]


def compiled(source):
    """The functions of a C source."""
    library = source.with_suffix(".so")
    line = [COMPILER, *STRICT, "-o", library, source, "-lm"]
    subprocess.run(line, check=True, capture_output=True)
    return ctypes.CDLL(str(library))


def joint_by(function, *given):
    """Angle, speed and acceleration by an exported function `*_at`."""
    values = [ctypes.c_double() for _ in range(3)]
    function(*given, *map(ctypes.byref, values))
    return [value.value for value in values]
