"""Trade-offs of residual and energy: found, imported, polished, compared, and those of problems.

May import every room of `studies` but those of the other commands.
"""
