"""Names of methods and budgets on the page."""

from __future__ import annotations

import re

from quietarm.metaheuristics import PRESETS

LABELS = {
    "epsilon": "gradient",
    "epsilon points=50": "gradient, 50 points",
    "epsilon points=10": "gradient, 10 points",
    "epsilon points=200": "gradient, 200 points",
    "epsilon points=3": "gradient, 3 points",
    "epsilon points=5": "gradient, 5 points",
    "multistart starts=100": "multistart",
    "nsga2+polish": "NSGA-II, polished",
    "gde3+polish": "GDE3, polished",
    "moead-de reevaluate=5": "MOEA/D-DE, up to five evaluations",
    "slsqp": "SLSQP",
    "slsqp continuation=False": "SLSQP, random starts",
    "slsqp in-turn=True": "SLSQP, every integer in turn",
    "slsqp step=0.01": "SLSQP, steps of 1 % of the box",
    "tpe": "TPE of Optuna",
    "slsqp step=0.1": "SLSQP, steps of 10 % of the box",
}
RANDOM_STARTS = "continuation=False"
"""Setting of SLSQP that pictures leave out."""


def short_label(method: str) -> str:
    """A method as text and pictures call it, with its settings where it has some."""
    if method in LABELS:
        return LABELS[method]
    name, _, settings = method.partition(" ")
    label = LABELS.get(name) or (PRESETS[name].label if name in PRESETS else name)
    if individuals := re.fullmatch(r"population=(\d+)", settings):
        return f"{label} of {individuals[1]}"
    return f"{label}, tuned" if "population=" in settings else f"{label} {settings}".strip()


def spelled_budget(budget: float) -> str:
    """A number of candidates with commas."""
    return f"{budget:,.0f}"


def two_digits(value: float | None) -> str:
    """Two significant digits, without an exponent; a dash where there is no number."""
    if value is None or value != value:
        return "-"
    if value in (float("inf"), float("-inf")):
        return "none"
    magnitude = abs(value)
    if magnitude >= 10:
        return f"{value:.0f}"
    return f"{value:.1f}" if magnitude >= 1 else f"{value:.2g}"


def signed(value: float) -> str:
    """Two digits with a sign, as of a difference; none if it is infinite."""
    return (
        two_digits(value)
        if value in (0, float("inf"))
        else f"{'+' if value > 0 else '-'}{two_digits(abs(value))}"
    )


def without_noise(method: str) -> str:
    """A method with its settings but the noise that it saw."""
    return " ".join(word for word in method.split() if not word.startswith("noise="))


def p_value(value: float | None) -> str:
    """A p value as it is printed."""
    if value is None or value != value:
        return "-"
    return f"{value:.2g}" if value >= 1e-4 else "< 0.0001"


def thousands(count: int) -> str:
    """A count with a comma between its thousands."""
    return f"{count:,}"


def bold(words: str) -> str:
    """Words in bold letters of Markdown; a dash stays as it is."""
    return words if words == "-" else f"**{words}**"


def capitalised(words: str) -> str:
    """Return words with a capital letter first; all others stay as they are."""
    return words[:1].upper() + words[1:]
