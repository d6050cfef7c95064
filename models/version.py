"""The version of quietarm, written once."""

__version__ = "1.0.0"
