"""What the paper prints: its conditions, coefficients and energies, and how a task is named.

May import `registry` and `display`.
"""
