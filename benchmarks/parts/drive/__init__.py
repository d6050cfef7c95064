"""Simulate machines that are not quietarm's model: a beam of finite elements on a real drive.

`beam`, `machines`, `simulate` and `measures` import nothing of quietarm, so that its plans are
judged by other equations than its own; `moves` and `recordings` are what its user does.
"""
