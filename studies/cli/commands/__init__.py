"""The commands, one file for each: `quietarm NAME` runs the function `NAME` of `ROOM/NAME.py`.

`moves` has those for single moves, `fronts` those for trade-offs of residual and energy, `studies`
those that compare many methods or moves. No room imports another.
"""
