"""Answers to test with, and ways to call the command."""

from command_fixtures import *  # noqa: F403
