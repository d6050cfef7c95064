"""A format that is not complete, or in the way of another, is refused when it is defined."""

import pytest

from quietarm.views import ExportFormat, ExportSetting, export_plan
from quietarm.views.formats.export_format import known_formats

pytestmark = pytest.mark.usefixtures("what_is_made_up_is_forgotten")


def define(**entries):
    """A format that is complete but for some entries; None leaves one out."""
    whole = {
        "name": "mine",
        "endings": (".mine",),
        "meaning": "a test",
        "content": lambda self, plan: "content",
    }
    given = {name: value for name, value in (whole | entries).items() if value is not None}
    return type("Mine", (ExportFormat,), given)


@pytest.mark.parametrize(
    ("entries", "told"),
    [
        ({"endings": None}, r"format Mine has no endings; give one, such as endings = \('\.nc',\)"),
        ({"meaning": None}, "format Mine has no meaning"),
        ({"content": None}, r"format Mine writes nothing; define content\(self, plan, ...\)"),
        ({"endings": ".nc"}, r"endings of Mine are '\.nc'; give them as \('\.nc',\)"),
        ({"endings": ()}, r"endings of Mine are \(\)"),
        ({"endings": ("nc",)}, r"ending 'nc' of Mine is none; give one as '\.nc'"),
        ({"endings": (".NC",)}, r"ending '\.NC' of Mine is none"),
        ({"endings": (".json",)}, r"ending \.json of Mine is for other files"),
        ({"takes": ("plans",)}, "unknown answer that Mine takes 'plans'; did you mean 'plan'"),
        ({"settings": (ExportSetting("a", 1, ""),) * 2}, "Mine has a setting twice among a, a"),
    ],
)
def test_a_format_that_is_not_complete_is_refused(entries, told):
    with pytest.raises(ValueError, match=told):
        define(**entries)
    assert "mine" not in known_formats()


def test_a_format_in_the_way_of_another_is_refused():
    kind = define(endings=(".c",))
    with pytest.raises(ValueError, match=r"ending \.c of Mine is that of the format c"):
        known_formats()
    kind.endings = (".mine",)
    kind.__init__ = lambda self, feed: None
    with pytest.raises(ValueError, match="Mine needs feed; give each a default"):
        known_formats()
    kind.name = "csv"
    with pytest.raises(ValueError, match="name 'csv' of Mine is that of quietarm's CsvRows"):
        known_formats()


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (("output", 1, ""), "setting 'output' has no free name"),
        (("feed rate", 1, ""), "setting 'feed rate' has no free name"),
        (("feed", None, ""), "setting feed is None; give a number or a text, or say its kind"),
        (("feed", 0.5, "", 1.0, 2.0), "feed is 0.5; give a number from 1 up to 2"),
    ],
)
def test_a_setting_that_cannot_be_given_is_refused(given, told):
    with pytest.raises(ValueError, match=told):
        ExportSetting(*given)


def test_what_a_format_returns_is_checked(cycloid, tmp_path):
    kinds = [define(content=lambda self, plan: None)]  # a class that nobody holds is gone
    with pytest.raises(ValueError, match="content of the format mine returns None; return text"):
        export_plan(cycloid, tmp_path / "move.mine")
    kinds.append(define(content=lambda self, plan: {}["a"]))
    with pytest.raises(ValueError, match=r"format mine .*fails: KeyError: 'a'; mend it"):
        export_plan(cycloid, tmp_path / "move.mine")
    assert not list(tmp_path.iterdir())


def test_the_order_of_formats_does_not_depend_on_what_was_loaded_first():
    kind = define(name="a")
    names = list(known_formats())
    assert names == [*sorted(names[:-1]), kind.name]
