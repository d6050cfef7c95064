"""Pictures that move: structures in motion, as a GIF or an MP4.

`clock` says when the frames are, `cast` where the structures are then, `stage` draws that, `film`
makes a file of the frames. May import `figures` and `display`.
"""

from quietarm.studies.animation.film import Animation, animate

__all__ = ["Animation", "animate"]
