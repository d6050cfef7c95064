"""What a motion leaves and costs when the plant is not the assumed one.

From a plant with errors (`plants`) over many of them at once (`population`) to the figures
(`measures`). May import `simulation`, `profiles`, `task` and `base`.
"""
