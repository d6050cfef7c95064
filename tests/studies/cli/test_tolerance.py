"""--tolerance reaches every solve of a line, as the solvers' own loops are given it."""

import pytest
from lines import MOVE

from quietarm.ocp import CycloidPolynomial, epsilon_front
from quietarm.ocp.floor import program
from quietarm.ocp.floor.program import FloorProgram
from quietarm.ocp.solvers import ipopt, sqp

TOLERANCE = 3e-7
EXPECTED = {
    "sqp": TOLERANCE,
    "ipopt": TOLERANCE,
    "floor": FloorProgram.larger_tolerance * TOLERANCE,
}
COARSE = "single-link --duration 0.8 --terms 2"
FASTEST = MOVE.replace("0.8", "fastest")


@pytest.fixture
def seen(monkeypatch):
    """Note what ends the iterations of each solver where these begin."""
    by_solver = {}
    minimise = sqp.minimise

    def by_sqp(programs, x, course, **settings):
        by_solver.setdefault("sqp", set()).add(course.solver.tolerance)
        return minimise(programs, x, course, **settings)

    monkeypatch.setattr(sqp, "minimise", by_sqp)
    for name, module in (("ipopt", ipopt), ("floor", program)):

        def compiled(nlp, options, name=name, compile_nlp=module.compile_nlp):
            by_solver.setdefault(name, set()).add(options["tol"])
            return compile_nlp(nlp, options)

        monkeypatch.setattr(module, "compile_nlp", compiled)
    ipopt.compile_program.cache_clear()  # else a program of another test is not seen
    return by_solver


@pytest.mark.slow
@pytest.mark.parametrize(
    ("line", "status", "solvers"),
    [
        (f"plan {MOVE} --terms 2", 0, {"sqp"}),
        (f"plan {MOVE} --torque-limit 0.2", 0, {"sqp"}),  # six terms, then 18
        (f"plan {MOVE} --terms 2 --solver ipopt", 0, {"ipopt"}),
        (f"plan {MOVE} --terms 2 --starts 1 --torque-limit 0.1", 1, {"sqp"}),
        (f"plan {MOVE} --terms 2 --starts 1 --error frequency=5%", 0, {"sqp", "ipopt"}),
        (f"plan {MOVE} --profile free --starts 2", 0, {"sqp", "floor"}),
        (f"plan {FASTEST} --acceleration-limit 40", 0, {"sqp"}),
        (f"plan {FASTEST} --acceleration-limit 40 --terms 2", 0, {"sqp", "ipopt"}),
        (f"front {MOVE} --terms 2 --bound 0.3 --points 3 --check", 0, {"sqp", "ipopt"}),
        (f"front {MOVE} --terms 2 --bound 0.3 --points 3 --method weighted", 0, {"sqp"}),
        (f"front {MOVE} --terms 2 --bound 0.3 --points 3 --error frequency=5%", 0, {"sqp"}),
        ("front --polish front.json", 0, {"sqp"}),
        ("front --polish front.json --solver ipopt", 0, {"ipopt"}),
        (f"sweep {COARSE} --target 0.4,0.5 --front 3 --output m.zarr", 0, {"sqp"}),
        (f"sweep {COARSE} --target 0.4,0.5 --torque-limit 0.1 --output m.zarr", 0, {"sqp"}),
        (f"sweep {COARSE} --target 0.4,0.5 --error frequency=5% --output m.zarr", 0,
         {"sqp", "ipopt"}),
        ("compare front.json", 0, {"sqp", "floor"}),
    ],
)  # fmt: skip
def test_every_solve_of_a_line_has_it(call, folder, task, seen, line, status, solvers):
    if "front.json" in line:
        front = epsilon_front(task, CycloidPolynomial(2), bound=0.3, points=3, starts=1)
        front.save("front.json")
        seen.clear()
    assert call(f"{line} --tolerance 3e-7 --quiet")[0] == status
    assert seen == {name: {EXPECTED[name]} for name in solvers}
