"""Ways in which a joint may move: the base of every profile, and the profiles, one class a file.

May import no other room.
"""
