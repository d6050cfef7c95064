"""The command `quietarm`: its commands, their options, and its error messages.

May import every room; no other room imports this one or knows click.
"""

from quietarm.studies.cli.application import main, quietarm

__all__ = ["main", "quietarm"]
