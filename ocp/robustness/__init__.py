"""What a motion leaves and costs when the plant is not the assumed one.

From a plant with errors (`uncertain`) over many of them at once (`population`) to the figures
(`measures`). May import `simulation` and `profiles`.
"""
