"""The command `quietarm`: its commands, their options, and what is said of errors.

May import every room; no other room imports this one or knows click.
"""

from studies.cli.application import main, quietarm

__all__ = ["main", "quietarm"]
