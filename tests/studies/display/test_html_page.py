"""Pages of HTML: escaped, well-formed, self-contained."""

import base64
import xml.etree.ElementTree as ElementTree

from matplotlib.figure import Figure
from quietarm.studies.display.html_page import (
    Markup,
    bullets,
    element,
    joined,
    page,
    picture,
    table_element,
)
from quietarm.studies.display.tables import Column, Table

NASTY = '<script>alert("1 & 2")</script>'


def test_text_is_escaped_and_markup_is_not_escaped_twice():
    inner = element("b", NASTY)
    assert inner == '<b>&lt;script&gt;alert("1 &amp; 2")&lt;/script&gt;</b>'
    assert element("p", inner, " & so on") == f"<p>{inner} &amp; so on</p>"
    assert joined(["<", Markup("<br/>")]) == "&lt;<br/>"


def test_attributes_are_escaped():
    text = element("img", alt=NASTY, class_="wide")
    root = ElementTree.fromstring(text)
    assert root.attrib == {"alt": NASTY, "class": "wide"}


def test_a_page_is_well_formed_and_says_how_wide_it_is():
    text = page(NASTY, bullets([NASTY, "second"]))
    assert text.startswith("<!DOCTYPE html>\n")
    root = ElementTree.fromstring(text)
    assert root.get("lang") == "en"
    assert root.find("head/title").text == NASTY
    assert [item.text for item in root.findall("body/ul/li")] == [NASTY, "second"]
    metas = {meta.get("name"): meta.get("content") for meta in root.findall("head/meta")}
    assert metas["viewport"] == "width=device-width, initial-scale=1"


def test_a_table_scrolls_within_itself_and_names_rows_and_columns():
    table = Table(
        "Energies",
        [Column("method"), Column("energy [J]", "{:.2f}".format), Column("  quartiles")],
        [["NSGA-II", 0.123, "1 to 2"], ["VEPSO", None, None]],
    )
    root = ElementTree.fromstring(f"<div>{table_element(table)}</div>")
    assert root.find("h3").text == "Energies"
    scroll = root.find("div")
    assert (scroll.get("class"), scroll.get("tabindex")) == ("scroll", "0")
    assert scroll.get("aria-label") == "Energies"
    assert [cell.text for cell in scroll.findall("table/thead/tr/th")] == [
        "method", "NSGA-II", "VEPSO"
    ]  # fmt: skip
    first, second = scroll.findall("table/tbody/tr")
    assert [cell.text for cell in first] == ["energy [J]", "0.12", "-"]
    assert (second[0].text, second[0].get("class"), second[0].get("scope")) == (
        "quartiles", "part", "row"
    )  # fmt: skip


def test_a_picture_is_inside_the_page_with_words_for_those_who_do_not_see_it():
    figure = Figure(figsize=(2, 1))
    figure.subplots().plot([0, 1], [0, 1])
    root = ElementTree.fromstring(picture(figure, "A line.", "A line & no more"))
    image = root.find("img")
    assert image.get("alt") == "A line."
    head, data = image.get("src").split(",")
    assert head == "data:image/svg+xml;base64"
    assert ElementTree.fromstring(base64.b64decode(data)).tag == "{http://www.w3.org/2000/svg}svg"
    assert root.find("figcaption").text == "A line & no more"
