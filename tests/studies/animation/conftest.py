"""What the tests of animations share: one small GIF."""

import pytest
from quietarm.studies.animation import animate
from quietarm.studies.figures import Line


@pytest.fixture(scope="session")
def film(plan, cycloid):
    """The plain cycloid beside the plan: 1.8 s of the README's move, 19 frames."""
    lines = [Line(cycloid, "plain cycloid"), Line(plan, "plan")]
    return animate(lines, width=240, frames_per_second=10)
