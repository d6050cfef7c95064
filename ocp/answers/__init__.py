"""How answers are saved and loaded, and what they say of their origin.

May import `simulation`, `profiles`, `task` and `base`.
"""
