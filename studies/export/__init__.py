"""Moves in the forms that controllers read: tables, C, ROS 2, MATLAB.

May import `sweep` and `display`.
"""

from quietarm.studies.export.formats import FORMATS, export_plan

__all__ = ["FORMATS", "export_plan"]
