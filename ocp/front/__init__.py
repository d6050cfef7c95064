"""The trade-off between residual and energy: the answer, and the ways to it by gradient.

May import `planning` and the rooms below it, but not `floor`.
"""
