"""Simulate motions: fixed steps for the optimisers, CVODES for the figures that are reported.

May import `profiles`. The fixed steps (`rollout`; of many candidates `evaluator`) and CVODES
(`cvodes`) share the equations, the energy's quadrature and the residual, but no integrator.
"""
