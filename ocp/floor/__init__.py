"""The least energy over all joint motions: the search over grids, its program, the answer.

May import `planning` and the rooms below it, but not `front`.
"""
