"""What a motion leaves and costs when the plant is not the assumed one.

From one motion on plants with errors (`perturbed`) to the figures (`measures`). May import
`simulation`, `profiles`, `solvers.batch`.
"""
