"""Residual and energy of a motion on perturbed plants.

From one motion on perturbed plants (`perturbed`) to the measures (`measures`). May import
`simulation`, `profiles`, `solvers.batch`.
"""
