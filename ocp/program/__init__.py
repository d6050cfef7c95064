"""The nonlinear program over a profile's coefficients, with its derivatives, and one run of IPOPT.

From one step of the simulation (`step_model`) to a task's numbers in the program (`task_program`).
May import `simulation`, `profiles`, `task` and `base`.
"""
