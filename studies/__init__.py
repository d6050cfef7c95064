"""The command line, and the studies behind it.

Rooms, each of which may import those after it: `cli`; `contest`, `reproduction` and `study`;
`explore` and `versus`; `reports`; `animation`; `figures`; `comparison`; `reading` and `export`;
`sweep`, `paper` and `document`; and last `identify`, `display` and `registry`, which names methods
and joint profiles. All of them may import the other three packages. Of use from outside are
`identify`, and `figures` and `animation`, which draw.
"""
