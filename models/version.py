"""The version of quietarm, written once."""

__version__ = "0.1.0"
