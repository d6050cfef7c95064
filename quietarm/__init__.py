"""Point-to-point moves of flexible robot arms that arrive at rest and take little energy.

    import quietarm as qa

    task = qa.PointToPoint(qa.SingleLinkManipulator(), target=qa.deg(30), duration=0.8)
    plan = qa.plan_move(task)

Every public name of `quietarm.models`, `quietarm.ocp` and `quietarm.metaheuristics`, and of
`figures`, `compare`, `identify`, `bench` and `sweep` in `quietarm.studies`; each package is
imported with the first of its names that is asked for.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

_HERE = Path(__file__).parent
if not (_HERE / "ocp").is_dir():
    __path__.append(str(_HERE.parent))  # in a checkout the packages stand beside this one

if TYPE_CHECKING:
    from quietarm.metaheuristics import *  # noqa: F403
    from quietarm.models import *  # noqa: F403
    from quietarm.ocp import *  # noqa: F403
    from quietarm.studies.bench import *  # noqa: F403
    from quietarm.studies.compare import *  # noqa: F403
    from quietarm.studies.figures import *  # noqa: F403
    from quietarm.studies.identify import *  # noqa: F403
    from quietarm.studies.sweep import *  # noqa: F403

_PACKAGES = (
    "models", "ocp", "metaheuristics",
    "studies.figures", "studies.compare", "studies.identify", "studies.bench", "studies.sweep",
)  # fmt: skip


def __getattr__(name: str) -> Any:
    if name in ("models", "ocp", "metaheuristics", "studies"):
        return import_module(f"quietarm.{name}")
    if not name.startswith("_") or name == "__version__":
        for package in _PACKAGES:
            module = import_module(f"quietarm.{package}")
            if name in module.__all__:
                return getattr(module, name)
    raise AttributeError(f"module 'quietarm' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({name for one in _PACKAGES for name in import_module(f"quietarm.{one}").__all__})
