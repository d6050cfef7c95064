"""How a joint may move: what every profile is, and the profiles, one class a file.

May import no other room.
"""
