"""Flexible parts that a URDF does not have: a beam, springs of joints, a base that rocks.

It knows links of a URDF, and no robot.
"""
