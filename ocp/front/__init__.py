"""The trade-off between residual and energy: the answer, and the ways to it by gradient.

May import `plan` and the rooms below it, but not `floor`.
"""
