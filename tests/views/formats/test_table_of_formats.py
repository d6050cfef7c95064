"""Lists of formats are made from the table of formats: in the help, the docs and messages."""

import re

from pages import PAGES

from quietarm.views.formats.export_format import known_formats


def rows_of_formats():
    """The table of docs/controllers.md, from what every format says of itself."""
    yield "| File | Contents | Written from | Settings |"
    yield "|---|---|---|---|"
    for form in known_formats().values():
        endings = ", ".join(f"`{ending}`" for ending in (*form.endings, *form.beside))
        settings = [s.option for s in form.settings if s.type_of_value is not object]
        options = ", ".join(f"`{option}`" for option in settings) or "-"
        yield f"| {endings} | {form.meaning} | {form.taken} | {options} |"


def test_the_docs_list_the_formats():
    (table,) = re.findall(r"^\| File \| Contents .*?(?=\n\n)", PAGES["controllers"], re.M | re.S)
    assert table.splitlines() == list(rows_of_formats())


def test_the_help_lists_the_formats_and_only_what_can_go_to_standard_output(done):
    told = " ".join(done("export --help").split())
    for form in known_formats().values():
        assert f"{form.meaning}, of {form.taken}" in told
    possible = [form.name for form in known_formats().values() if form.to_stdout]
    assert f"--format [{'|'.join(possible)}]" in told.replace("| ", "|")
    assert "mat" not in possible
