"""Names that would be code, markup, formulas or orders where they are written as they are."""

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from quietarm.models import JointMotion, Plant

MARKS = [
    '"', "'", "\\", "\\n", '\\"', "??/", "??/\n", "??'", '??""', "%s%n", "%d", "*/", "**//", "/*",
    "*//*", "//", "\\\n", "\n", "\r", "\r\n", "\t", "\v\f", "\x1b[31m", "\x1b]0;t\x07", "\x9b2J",
    "\x00", "\x08", "\x7f", "\x85", "\u2028", "\u2029", "\u202e", "\u2066", "\u200b", "\ufeff",
    "=SUM(1,2)", "+1", "-1", "@A1", "\t=1", " =1", "'=1", "\uff1d1", ",", ";", "a,b;c", '","',
    "|", "a|b", "`", "``x`", "*b*", "_b_", "__b__", "~~s~~", "# h", "> q", "- i", "1. i",
    "[l](http://x.y)", "![i](javascript:0)", "[r]: http://x.y", "<http://x.y>", "<b>",
    "<img src=x onerror=0>", "</script>", "</script><script>", "<!--", "-->", "]]>", "&", "&lt;",
    "&#10;", "{{ 1 }}", "{% x %}", "{#", "[red]", "[/red]", "[/]", "$", "$x$", "$$x$$", "$(x)",
    "\\input{x}", "{", "}", "~", "^", "#", "%", "\u00e9", "\u03a9", "\U0001f916",
    "\U0001f468\u200d\U0001f469", "\u05d0", "e\u0301", ": ", "- ", "? ", "!tag", "*alias", "&a",
    "null", "1e5", "0x1", "yes", "~", " ", "  a  ", "n" * 3000,
]  # fmt: skip
"""What one format or another takes for its own."""
INJECTED = 'a"};int injected=1;static const char*const z[]={"'
NAMES = list(dict.fromkeys([*MARKS, INJECTED, *(f"a{mark}b" for mark in MARKS[:32])]))
LABEL = "arm **// int injected=1; /**//* ??/ \\ */ \u202e\n#error injected\n*/ int injected=2; /*"


@dataclass(frozen=True)
class Hostile(Plant):
    """A pendulum by as many joints as there are names."""

    name: ClassVar[str] = "hostile"
    modes: ClassVar[int] = 1

    @property
    def label(self):
        """Name in reports."""
        return LABEL

    @property
    def joint_names(self):
        """One for each joint."""
        return tuple(NAMES)

    def modal_accelerations(self, joint, W, dW):
        """A swing at 10 rad/s."""
        return [-100 * W[0] - 0.2 * dW[0] - joint.acceleration]

    def joints(self, path):
        """Joints that move alike."""
        return [JointMotion(*path) for _ in NAMES]

    def torques(self, path, W, dW, ddW):
        """Return torques of an inertia, and of the swing in the first joint."""
        rigid = [path.acceleration * ca.DM(1.0) for _ in NAMES]
        return [rigid[0] + path.acceleration + 0.1 * ddW[0], *rigid[1:]]

    def tips_at(self, path, W):
        """Where the pendulum is."""
        return [0.1 * W[0]]

    def tip_speeds(self, path, W, dW):
        """Return the speed of the tip."""
        return [0.1 * dW[0]]
