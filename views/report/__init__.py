"""Reports of results: rows and Markdown templates, words, tables, pictures and progress."""

from quietarm.loading import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
