"""What is minimised: residual, energy and violations of a whole population, as a pymoo problem.

It may import `ocp` and `models`, and nothing else of `metaheuristics`.
"""
