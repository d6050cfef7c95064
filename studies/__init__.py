"""The command line, and the studies behind it.

Rooms: `cli` has the commands; `bench`, `compare`, `reproduce`, `sweep`, `identify`, `export` and
`explore` what they do; `figures` draws, `report` writes, `reading` reads files, and `registry`
names methods and joint profiles. All of them may import the other three packages.
"""
