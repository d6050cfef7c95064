"""The command line, and the studies behind it.

Rooms: `cli` has the commands; `bench`, `compare`, `reproduce`, `sweep`, `identify`, `export` and
`explore` what they do; `figures` draws, `report` writes, and `reading` knows what files and users
call things. All of them may import the other three packages.
"""

from quietarm.loading import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
