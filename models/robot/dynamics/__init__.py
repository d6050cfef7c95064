"""Equations of a robot, whatever its joints do: its bodies, their motion, modes, where a link is.

It knows no path; of a robot it knows `RobotParts`.
"""
