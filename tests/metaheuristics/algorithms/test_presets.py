"""The registry of the algorithms that are known by name."""

import pytest

from metaheuristics import PRESETS, VEPSO, PaperNSGA2


def test_the_papers_settings_are_the_defaults():
    # sections 3.1 and 3.2
    settings = {name: (p.population, p.generations) for name, p in PRESETS.items()}
    assert settings == {"vepso": (100, 200), "nsga2": (200, 500)}


def test_presets_are_known_by_their_names_and_have_labels():
    assert [preset.name for preset in PRESETS.values()] == list(PRESETS)
    assert {name: preset.label for name, preset in PRESETS.items()} == {
        "vepso": "VEPSO",
        "nsga2": "NSGA-II",
    }


@pytest.mark.parametrize(
    ("name", "kind", "size"), [("vepso", VEPSO, "particles"), ("nsga2", PaperNSGA2, "pop_size")]
)
def test_a_preset_builds_a_new_algorithm_of_the_population_given(name, kind, size):
    one, other = PRESETS[name].build(30), PRESETS[name].build(30)
    assert type(one) is kind
    assert getattr(one, size) == 30
    assert one is not other
