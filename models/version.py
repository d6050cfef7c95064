"""The version of quietarm, written once."""

__version__ = "2.0.0.dev0"
