"""Pictures that move: structures in motion, as a GIF or an MP4.

`cast` says where the structures are at every frame, `stage` draws that, `formats` makes a file of
the frames. May import `figures` and `display`.
"""

from quietarm.studies.animation.film import Animation, animate

__all__ = ["Animation", "animate"]
