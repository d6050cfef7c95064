"""What a motion costs: fixed steps for the optimisers, CVODES for the figures that are reported.

May import `profiles`. The fixed steps (`rollout`) and CVODES (`cvodes`)
share the equations, the energy's quadrature and the residual, but no integrator.
"""
