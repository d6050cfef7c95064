"""The nonlinear programs over a profile's coefficients, many at once, and what solves them.

From what happens at one time (`node`) over the motion of rows of candidates with its derivatives
(`expressions`, `batch`) to a task's numbers (`program`) and rows of programs with what is asked of
them (`stack`). These are solved by sequential quadratic programs (`sqp`) or by IPOPT (`interior`);
`solving` runs either and says what came of it in SI units. May import `simulation`, `profiles`
and `robustness`.
"""
