"""Read a URDF: its links and joints, joints that follow others, and limits beside it.

It knows nothing of what bends.
"""
