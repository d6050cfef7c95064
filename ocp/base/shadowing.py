"""Name a user's own file that takes the place of one of quietarm's packages."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path


def refuse_shadow(package: str) -> None:
    """Make sure that a package of quietarm is what an import of its name finds.

    Parameters
    ----------
    package : str
        A top-level package of quietarm.

    Raises
    ------
    ImportError
        When another file or folder is found instead; the text names it.
    """
    ours = Path(__file__).resolve().parents[2] / package
    loaded = sys.modules.get(package)
    spec = loaded.__spec__ if loaded is not None else find_spec(package)
    found = spec.origin if spec is not None else getattr(loaded, "__file__", None)
    if found is None and spec is not None and spec.submodule_search_locations:
        found = next(iter(spec.submodule_search_locations))
    if found is not None and ours not in (Path(found).resolve(), Path(found).resolve().parent):
        raise ImportError(
            f"{found} takes the place of quietarm's package {package!r}; rename that file, or move "
            "it away from your script"
        )
