"""Write notebooks as pages or slides that need no network: one file each, with all that is in it.

    python notebooks/offline.py [--slides] [--output FOLDER] NOTEBOOK...

Slides show headings, equations, lists with the sentence before them, questions and programs; all
other sentences are speaker notes (key S), unless a slide has room for them. What a cell shows
appears when you go on; of cells that draw there is the picture.
"""

import argparse
import re
import sys
from html import escape
from importlib.resources import files
from pathlib import Path

from jinja2 import pass_context
from latex2mathml.converter import convert
from nbconvert import HTMLExporter, SlidesExporter
from nbconvert.filters.markdown_mistune import IPythonRenderer, MarkdownWithMath
from slides import as_slides

WALL = {"reveal_width": "1152", "reveal_height": "648"}
"""Slides as wide and as high [pixels]; what shows them enlarges them."""
_TAG = re.compile(r"\\tag\{(.*?)\}")
_FROM_THE_NETWORK = re.compile(
    r"<script[^>]*\ssrc=\"https?://[^\"]*\"[^>]*>\s*</script>"
    r"|<link[^>]*\shref=\"https?://[^\"]*\"[^>]*>"
    r"|<script type=\"module\">[^<]*mermaid.*?</script>",
    re.DOTALL,
)
_UNDESCRIBED = re.compile(r'alt="No description[^"]*"')
_FRAME = re.compile(r'(?P<before><iframe[^>]*?)src="(?P<name>[\w.-]+\.html)"')
"""Of a page that stands beside the notebook."""
_FRAME_ON_THE_WALL = """<style>
main { max-width: none; padding: 0; }
header { margin: 0; }
.words, footer { display: none; }
</style>"""
"""On a slide a page to drag is as wide as the slide; who stands beside it says what one does."""
_STYLE = """<style>
.equation { display: flex; align-items: center; margin: 1em 0; }
.equation div { flex: 1; }
.equation mtd[columnalign="left"] { text-align: left; }
math {
  font-family: "STIX Two Math", "STIX Math", "Cambria Math", "Latin Modern Math",
    "DejaVu Math TeX Gyre", math;
}
mover:not([accent]) > mo:last-child:not([accent]) {
  font-size: 1.5em; font-weight: bold; line-height: 1;
}
details .highlight { margin-bottom: 0.7em; }
.celltag_hide-input .jp-Cell-inputWrapper { margin: 0.5em 0; }
</style>"""
_FOLD = """<script>
for (const input of document.querySelectorAll(".celltag_hide-input .jp-Cell-inputWrapper")) {
  const fold = document.createElement("details");
  fold.innerHTML = "<summary>Code of the picture</summary>";
  input.replaceWith(fold);
  fold.append(input);
}
</script></body>"""
_ON_THE_WALL = """<style>
:root { --jp-content-font-size1: 21px; --jp-code-font-size: 17px; }
.reveal .slides section section { max-height: 100%; overflow-y: auto; padding: 0; }
.reveal section { text-align: left; }
.reveal :is(h1, h2, h3) { margin: 0 0 0.4em; }
.reveal h1 { font-size: 50px; }
.reveal h2 { font-size: 38px; }
.reveal h3 { font-size: 30px; }
.reveal p { margin: 0.7em 0; }
.reveal p:empty { display: none; }
.reveal ul, .reveal ol { display: block; }
.reveal math { font-size: 1.1em; }
.reveal .equation { font-size: 1.1em; margin: 0.6em 0; }
.reveal pre { margin: 0; width: 100%; box-shadow: none; line-height: 1.3; }
.reveal .highlight pre { white-space: pre-wrap; }
.reveal .unwrapped .equation { width: max-content; }
.reveal .unwrapped .equation div { flex: none; width: max-content; }
.reveal .unwrapped pre { white-space: pre !important; width: max-content !important; }
.reveal :is(.jp-InputArea, .jp-InputArea-editor) { overflow: visible; }
.reveal details pre { font-size: 15px; line-height: 18px; }
.reveal img { display: block; margin: 0 auto; max-width: 100%; }
.reveal .jp-Cell { padding: 0; }
.reveal div.jp-OutputArea-output > pre { padding: 0; width: 100%; }
.reveal .jp-RenderedText pre { word-break: normal; overflow-wrap: anywhere; }
.reveal :is(.jp-InputPrompt, .jp-OutputPrompt, .jp-Collapser) { display: none; }
.reveal .celltag_hide-input .jp-Cell-inputWrapper { display: none; }
.reveal .controls { font-size: 4px; }
</style>"""
_SCRIPTS = """<script>{reveal}</script>
<script>{notes}</script>
<script>
// what the slides' own script asks for is in this file already
const require = (options, addresses, begin) => begin(Reveal, RevealNotes);
const MathJax = {{ Hub: {{ getAllJax: () => false }} }};
const initialize = Reveal.initialize;
Reveal.initialize = (options) => initialize({{ ...options, center: false, margin: 0.06 }});
// a slide fills the wall: long ones get smaller, short ones larger, and no program or output is cut
async function fit({{ currentSlide: slide }}) {{
  await Promise.all([...slide.querySelectorAll("img")].map((image) => image.decode()));
  const {{ width, height }} = Reveal.getConfig();
  slide.style.zoom = 1;
  slide.classList.add("unwrapped");
  const widths = [...slide.querySelectorAll("pre, .equation")]
    .map((part) => part.offsetWidth + 64)
    .filter((wide) => wide < 1.2 * width); // what is wider is wrapped
  slide.classList.remove("unwrapped");
  const largest = Math.min(1.6, width / Math.max(1, ...widths));
  for (let round = 0; round < 6; round++) {{
    const high = slide.scrollHeight * slide.style.zoom;
    const wanted = slide.style.zoom * height / high;
    slide.style.zoom = Math.min(largest, Math.max(0.5, wanted));
  }}
  while (slide.scrollHeight > slide.clientHeight + 1 && slide.style.zoom > 0.5) {{
    slide.style.zoom -= 0.02;
  }}
}}
addEventListener("toggle", () => fit({{ currentSlide: Reveal.getCurrentSlide() }}), true);
Reveal.on("ready", fit);
Reveal.on("slidechanged", fit);
</script>"""


def _with_its_page(frame, folder, style):
    """A frame that has in it the page that it shows, with styles of its own."""
    page = (folder / frame["name"]).read_text(encoding="utf-8")
    page = page.replace("</head>", f"{style}</head>", 1)
    return f'{frame["before"]}srcdoc="{escape(page)}"'


def alternatives(notebook):
    """The texts of a notebook's pictures, in their order, which nbconvert's templates leave out."""
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    pictures = [output for output in outputs if "image/png" in output.get("data", {})]
    return [picture.metadata.get("image/png", {}).get("alt", "a picture") for picture in pictures]


class Typeset(IPythonRenderer):
    """Markdown with its equations as MathML."""

    def inline_math(self, body):
        return convert(body)

    def block_math(self, body):
        tag = _TAG.search(body)
        number = f"<span>({tag[1]})</span>" if tag else ""
        equation = convert(_TAG.sub("", body), display="block")
        return f'<div class="equation"><div>{equation}</div>{number}</div>'


class _Offline:
    """What pages and slides have in common."""

    head, foot = _STYLE, "</body>"
    in_frames = ""
    """What is added to the head of a page in a frame."""

    @pass_context
    def markdown2html(self, context, source):
        return MarkdownWithMath(renderer=Typeset(escape=False)).render(source)

    def default_filters(self):
        yield from super().default_filters()
        yield "markdown2html", self.markdown2html

    def from_notebook_node(self, nb, *given, **settings):
        page, resources = super().from_notebook_node(nb, *given, **settings)
        page = _FROM_THE_NETWORK.sub("", page)
        texts = map(escape, alternatives(nb))
        page = _UNDESCRIBED.sub(lambda _: f'alt="{next(texts)}"', page)
        folder = Path((resources.get("metadata") or {}).get("path") or ".")
        page = _FRAME.sub(lambda frame: _with_its_page(frame, folder, self.in_frames), page)
        page = page.replace("</head>", f"{self.head}</head>", 1)
        return page.replace("</body>", self.foot), resources


class Page(_Offline, HTMLExporter):
    """A page; the code of its pictures is folded."""

    foot = _FOLD


class Slides(_Offline, SlidesExporter):
    """Slides, which the arrow keys turn."""

    in_frames = _FRAME_ON_THE_WALL

    def from_notebook_node(self, nb, *given, **settings):
        nb.cells = as_slides(nb.cells)
        page, resources = super().from_notebook_node(nb, *given, **settings)
        output = 'class="jp-Cell-outputWrapper'
        return page.replace(f'{output}"', f'{output} fragment"'), resources

    @property
    def head(self):
        package = files("sphinx_revealjs") / "_static" / "revealjs"
        looks = [
            (package / "dist" / name).read_text() for name in ("reveal.css", "theme/simple.css")
        ]
        fonts = re.compile(r"@import[^;]*;")
        scripts = _SCRIPTS.format(
            reveal=(package / "dist" / "reveal.js").read_text(),
            notes=(package / "plugin" / "notes" / "notes.js").read_text(),
        )
        return f"<style>{fonts.sub('', ''.join(looks))}</style>{_STYLE}{_ON_THE_WALL}{scripts}"


def main():
    words = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    words.add_argument("notebooks", nargs="+", type=Path, metavar="NOTEBOOK")
    words.add_argument("--slides", action="store_true", help="slides in place of pages")
    words.add_argument("--output", type=Path, default=Path(), help="a folder; else the one here")
    arguments = words.parse_args()
    for notebook in arguments.notebooks:
        if not notebook.is_file():
            sys.exit(f"{notebook}: no such notebook")
    exporter = Slides(exclude_output_prompt=True, **WALL) if arguments.slides else Page()
    arguments.output.mkdir(parents=True, exist_ok=True)
    for notebook in arguments.notebooks:
        page, _ = exporter.from_filename(str(notebook))
        path = arguments.output / f"{notebook.stem}{'.slides' * arguments.slides}.html"
        path.write_text(page, encoding="utf-8")
        print("wrote", path)


if __name__ == "__main__":
    main()
