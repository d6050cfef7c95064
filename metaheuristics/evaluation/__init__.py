"""The objectives of a search: residual, energy and violations of a whole population, for pymoo.

It may import `ocp` and `models`, and nothing else of `metaheuristics`.
"""
