"""A robot on its path: its equations by a few modes, in tables of the place; in full; as a picture.

Of a robot it knows `MovingRobot`.
"""
