"""Trajectories of MoveIt planned anew by quietarm, so that what the arm carries arrives still."""
