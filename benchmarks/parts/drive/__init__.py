"""Simulate machines that are not quietarm's model: a beam of finite elements on a real drive.

Nothing here imports quietarm, so that its plans are judged by other equations than its own.
"""
