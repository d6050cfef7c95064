"""One run of an algorithm on a move: its generations, its checkpoint, its front.

It may import `quietarm.metaheuristics.algorithms`, `quietarm.metaheuristics.objective` and `ocp`.
"""
