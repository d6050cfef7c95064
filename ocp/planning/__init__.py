"""The least energy of one move: its solver, the check by CVODES, what to say where none exists.

May import `solvers` and the rooms below it.
"""
