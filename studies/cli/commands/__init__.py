"""The commands, one file for each: `quietarm NAME` runs the function `NAME` of `NAME.py`."""
