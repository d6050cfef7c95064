"""Pictures whose letters can be read on a phone, and that open in full at a tap.

A picture of a page has a variant for phones, `NAME-narrow.png` beside it, where
docs/make_pictures.py can stack its panels; one of a notebook has it in `notebooks/narrow`, by its
content, where tests/notebooks/refresh.py puts it. Every other one is shown there no smaller than
makes its letters nine pixels high, in a frame that scrolls. An author has nothing to remember: a
picture says itself how large it is on paper (matplotlib writes the dots per inch), and no letters
in it are smaller than 7 points.
"""

from __future__ import annotations

import hashlib
import posixpath
import re
import shutil
from html import escape
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from PIL import Image
from sphinx.application import Sphinx

PIXELS_AN_INCH = 93
"""At which letters of 7 points, the smallest of any figure, are 9 pixels high."""
DOTS_OF_A_SCREEN = 96
"""An inch, of a picture that does not say: that of a page in a browser."""
PHONE = "(max-width: 34em)"
"""Where the variants for phones are shown: they are 3.85 inches wide."""
_IMAGE = re.compile(r"(?P<link><a [^>]*>\s*)?<img (?P<attributes>[^>]*?)\s*/?>")
_SOURCE = re.compile(r'src="([^"]*)"')
_ALT = re.compile(r'alt="([^"]*)"')


def least_width(picture: Path) -> int:
    """Pixels of a page below which letters of a picture could not be read; 0 for a film.

    Films are drawn for a phone.
    """
    with Image.open(picture) as image:
        if image.format == "GIF":
            return 0
        dots = image.info.get("dpi", (DOTS_OF_A_SCREEN, DOTS_OF_A_SCREEN))[0]
        return round(PIXELS_AN_INCH * image.width / dots)


def narrow_variant(picture: Path, of_notebooks: Path) -> Path | None:
    """The same picture for phones, if there is one: beside it, or among those of notebooks."""
    beside = picture.with_name(f"{picture.stem}-narrow.png")
    if beside.exists():
        return beside
    content = hashlib.sha256(picture.read_bytes()).hexdigest()[:16]
    return next(of_notebooks.glob(f"*-{content}.png"), None)


def framed(tag: re.Match[str], picture: Path | None, variant: Path | None = None) -> str:
    """A picture of a page as it is shown: its variant for phones, or in a frame that scrolls."""
    attributes = tag["attributes"]
    source = _source_of(attributes)
    alt = _ALT.search(attributes)
    if alt is None or alt[1] == source:  # as Sphinx has it where nobody wrote one
        attributes = _ALT.sub("", attributes) + ' alt="picture that the cell above draws"'
    link = tag["link"] or f'<a class="picture" href="{escape(source)}">'
    end = "" if tag["link"] else "</a>"
    if picture is None:  # in the page itself, as films of notebooks
        return f"{tag['link'] or ''}<img {attributes}>"
    if variant is not None:
        narrow = posixpath.join(posixpath.dirname(source), variant.name)
        of_phones = f'<source media="{PHONE}" srcset="{narrow}">'
        return f"{link}<picture>{of_phones}<img {attributes}></picture>{end}"
    image = f'<img {attributes} style="--least: {least_width(picture)}px">'
    if tag["link"]:
        return f"{link}{image}"
    return f'<span class="frame">{link}{image}{end}</span>'


def _source_of(attributes: str) -> str:
    source = _SOURCE.search(attributes)
    return source[1] if source else ""


def _on_page(app: Sphinx, page: str, template: str, context: dict[str, Any], tree: Any) -> None:
    """Frame the pictures of a page, and bring their variants to the others."""
    if not (body := context.get("body")):
        return
    files = {name: Path(app.srcdir, file) for file, name in app.builder.images.items()}

    def frame(tag: re.Match[str]) -> str:
        source = _source_of(tag["attributes"])
        if source.startswith("data:"):
            return framed(tag, None)
        picture = files[unquote(posixpath.basename(source))]
        variant = narrow_variant(picture, Path(app.srcdir, "notebooks", "narrow"))
        if variant is not None:
            folder = Path(app.outdir, app.builder.imagedir)
            folder.mkdir(parents=True, exist_ok=True)
            shutil.copy(variant, folder)
        return framed(tag, picture, variant)

    context["body"] = _IMAGE.sub(frame, body)


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect with Sphinx."""
    app.connect("html-page-context", _on_page)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
