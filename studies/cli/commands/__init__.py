"""The commands, a file each: the command of `quietarm NAME` is `NAME` in `NAME.py`."""
