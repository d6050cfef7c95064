"""Fixtures to follow recipes: ways to call the command, in a folder of the test's own."""

import pytest
from command_fixtures import *  # noqa: F403


@pytest.fixture
def refused(call):
    """Type a line that must fail in one line; that line."""

    def type_one(line, status=2):
        code, out, err = call(line)
        assert (code, out, err.count("\n")) == (status, "", 1)
        assert err.startswith("quietarm: ")
        return err

    return type_one
