"""The command line, and the studies behind it.

Rooms: `cli` has the commands; `bench`, `compare`, `reproduce` and `sweep` do what they are named
after, and `answers` reads files. All of them may import the other packages.
"""

from quietarm.loading import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
