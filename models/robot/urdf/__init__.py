"""What is read of a URDF: its links and joints, which joints follow others, limits beside it.

It knows nothing of what bends.
"""
