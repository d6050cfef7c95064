"""The nonlinear programs over a profile's coefficients, and the two that solve them.

- `Ipopt` writes a problem down in CasADi as it stands and leaves its derivatives to CasADi.
- `Sqp` solves many at once with derivatives of its own: from what happens at one time (`node`)
  over the motion of rows of candidates (`derivatives`, `batch`) to scaled `programs` and their
  iterations (`funnel`, `quadratic`). Equations: docs/engine.md.

May import `simulation` and `profiles`.
"""
