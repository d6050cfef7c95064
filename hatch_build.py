"""What an editable installation needs: `quietarm` is linked to the packages that stand beside it.

Python and editors then find `quietarm.ocp` where it is, new files included. Wheels have no links.
"""

import os
import sys
from pathlib import Path

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

PACKAGES = ("models", "ocp", "metaheuristics", "machine", "views", "studies")


class PackageLinks(BuildHookInterface):
    """Makes `quietarm/ocp` and its like before an editable wheel is written."""

    def initialize(self, version: str, build_data: dict) -> None:
        """Link every package that has no link yet."""
        if version != "editable":
            return
        checkout = Path(self.root)
        for package in PACKAGES:
            link = checkout / "quietarm" / package
            if not link.exists():
                link.unlink(missing_ok=True)  # one that leads nowhere
                link_folder(link, checkout / package)


def link_folder(link: Path, folder: Path) -> None:
    """A relative link, or a junction on Windows, where links need a privilege."""
    if sys.platform == "win32":
        import _winapi

        _winapi.CreateJunction(str(folder), str(link))
    else:
        link.symlink_to(os.path.relpath(folder, link.parent), target_is_directory=True)
