"""Single moves: plans, given coefficients, energy floors, robustness, animations.

May import every room of `studies` but those of the other commands.
"""
