"""The command line, and the studies behind it.

Rooms, each of which may import those after it: `cli`, then `contest`, `reproduction` and `study`,
then `runs`, `animation`, `figures`, `comparison`, `paper`, and last `display` and `registry`, which
names methods and joint profiles. All of them may import the other three packages. Of use from
outside are `figures` and `animation`, which draw.
"""
