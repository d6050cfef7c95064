"""Messages about names that are not known."""

import pytest
from quietarm.ocp.base.names import has_no, unknown


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("singel-link", "unknown plant 'singel-link'; did you mean 'single-link'? (known: "),
        ("DUAL", "unknown plant 'DUAL'; did you mean 'dual-link'? (known: "),
        ("qqq", "unknown plant 'qqq' (known: "),
        ("", "unknown plant '' (known: "),
    ],
)
def test_the_nearest_name_is_asked_for_where_there_is_one(name, message):
    listed = "dual-link, single-link; your own by its file)"
    found = unknown("plant", name, ["dual-link", "single-link"], "; your own by its file")
    assert found == f"{message}{listed}"


@pytest.mark.parametrize(
    ("name", "known", "message"),
    [
        ("omga", ["omega", "zeta"], "; did you mean 'omega'? (it has: omega, zeta)"),
        ("qqq", ["omega", "zeta"], " (it has: omega, zeta)"),
        ("mass", ["omega", "alpha1"], " (it has: omega, alpha1)"),
        ("m", ["omega", "zeta"], " (it has: omega, zeta)"),
        (
            "freq",
            ["zeta", "frequency"],
            "; did you mean 'frequency'? (it has: zeta, frequency)",
        ),
        ("omga", [], " (it has: none)"),
    ],
)
def test_what_it_has_is_listed(name, known, message):
    assert has_no("crane", "parameter", name, known) == f"crane has no parameter {name!r}{message}"
