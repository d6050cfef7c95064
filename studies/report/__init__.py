"""How results are reported: rows and Markdown templates, words, tables, pictures and progress."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
