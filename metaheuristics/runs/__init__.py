"""One run of an algorithm on a move: its generations, its checkpoint, its front.

It may import `metaheuristics.algorithms`, `metaheuristics.objective` and `ocp`.
"""
