"""The pages that a reader follows: README and docs, and the code blocks in them."""

import re
import shlex
from pathlib import Path

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text()
DOCS = {path.stem: path.read_text() for path in sorted((ROOT / "docs").glob("*.md"))}
PAGES = {"README": README, **DOCS}


def blocks(page: str, language: str) -> list[str]:
    """The code blocks of one language on a page, in order."""
    return re.findall(rf"^```{language}\n(.*?)^```$", PAGES[page], re.DOTALL | re.MULTILINE)


def shown_file(page: str, name: str) -> str:
    """The Python file that a page shows, whose first line is its name in a comment."""
    return next(block for block in blocks(page, "python") if block.startswith(f"# {name}\n"))


TWO_COMMANDS = [block.strip() for block in blocks("README", "console")[:2]]
"""What .ci/run takes from the README; what stands before them has another fence."""
COMMAND_BLOCKS = {
    f"{page}-{number}": block.strip().splitlines()
    for page in PAGES
    for number, block in enumerate(blocks(page, "(?:console|sh)"))
    if block.strip() not in TWO_COMMANDS
}
"""The commands of a move of one's own, block by block."""

COMMANDS = [shlex.split(line) for lines in COMMAND_BLOCKS.values() for line in lines]
