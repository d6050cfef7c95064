"""What recipes are followed with: ways to call the command, in a folder of the test's own."""

from command_fixtures import *  # noqa: F403
