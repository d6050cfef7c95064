"""Doors of learning: a recording is of the plan's move, whole, in its units and by its clock."""
