"""The site: docs, notebooks, every public name and every command, without a network.

    python -m pip install -c constraints.txt ".[site]"
    sphinx-build -W --keep-going -c docs . build/site

It is strict: a broken link or a name that cannot be documented ends the build.
Notebooks are shown as they are committed, with outputs that the tests hold against a fresh run.
"""

import re
import shutil
import sys
from importlib import import_module
from inspect import ismodule
from pathlib import Path
from textwrap import indent
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.pycode import ModuleAnalyzer

from quietarm import __version__
from quietarm.studies.cli.application import COMMANDS

sys.path.insert(0, str(Path(__file__).with_name("_extensions")))
from site_front import page_of_fronts  # beside the extensions

project, author, release = "quietarm", "The quietarm developers", __version__
copyright = f"2026, {author}"  # noqa: A001  # as Sphinx calls it
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_click",
    "sphinx_copybutton",
    "sphinx_inline_tabs",
    "glossary_links",
    "page_names",
    "readable_pictures",
    "reference_texts",
    "search_snippets",
    "stacked_tables",
    "whole_words",
]
root_doc = "docs/index"
include_patterns = [
    "docs/**",
    "notebooks/*.ipynb",
    "notebooks/README.md",
    "ros/quietarm_moveit/README.md",
    "README.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
]
exclude_patterns = ["docs/_*", "docs/paper/**"]
html_theme, html_title = "furo", "quietarm"
html_static_path, html_extra_path = ["_static"], ["_root"]
html_css_files, html_js_files = ["site.css"], ["front.js", "scrolling.js"]
html_search_scorer = str(Path(__file__).with_name("_static") / "search_order.js")
html_show_sphinx, html_copy_source, smartquotes = False, False, False
html_show_search_summary = False  # search_snippets.js has them without a server
html_theme_options = {"top_of_page_buttons": []}
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 4
nb_execution_mode = "off"  # they are committed executed
nb_ipywidgets_js = {}  # sliders move where a kernel runs; here a picture stands for each
html_math_renderer = "mathml"
default_role = "code"
autodoc_member_order = "groupwise"
autodoc_typehints = "none"
autodoc_preserve_defaults = True  # as they stand in the source, without addresses
toc_object_entries_show_parents = "hide"
napoleon_numpy_docstring, napoleon_google_docstring = True, False
suppress_warnings = ["ref.python"]  # a shape as (points, 2) looks like a name
_ROOMS = {
    "machine": {"identify": "Identification", "learn": "Learning"},
    "views": {"pictures": "Pictures"},
    "studies": {"sweep": "Grids of moves", "bench": "Benches", "compare": "Comparison"},
}
"""Rooms whose names stand on the page of their package, below its own."""
_TAG = re.compile(r"\\tag\{(.*?)\}")


def _inline(self, node):
    self.body.append(convert(node.astext()))
    raise nodes.SkipNode


def _display(self, node):
    text = node.astext()
    tag = _TAG.search(text)
    number = f'<span class="number">({tag[1]})</span>' if tag else ""
    equation = convert(_TAG.sub("", text), display="block")
    self.body.append(f'<div class="equation">{equation}{number}</div>')
    raise nodes.SkipNode


def _described(package, name, value):
    """What autodoc is asked for a public name."""
    if value is Any or not callable(value):
        return _constant(package, name, value)
    if isinstance(value, type):
        kind = "exception" if issubclass(value, BaseException) else "class"
        members = "" if issubclass(value, (BaseException, tuple)) else _members(package, value)
        return f".. auto{kind}:: quietarm.{package}.{name}\n{members}"
    return f".. autofunction:: quietarm.{package}.{name}\n"


def _members(package, value):
    """All members of a class: its own, and those of bases that have no entry of their own."""
    public = set(import_module(f"quietarm.{package}").__all__)
    described = [
        base.__name__
        for base in value.__mro__[1:]
        if base.__name__ in public or not base.__module__.startswith("quietarm.")
    ]
    return f"   :members:\n   :inherited-members: {', '.join(described)}\n"


def _constant(package, name, value):
    """A constant by the name with which it is imported: autodoc knows the one of its module."""
    shown = f"   :value: {value!r}\n" if isinstance(value, (int, float, str)) else ""
    words = ModuleAnalyzer.for_module(_home(name)).find_attr_docs()["", name]
    text = indent("\n".join(words), "   ")
    return f".. data:: quietarm.{package}.{name}\n{shown}\n{text}\n"


def _home(name):
    """The module that defines a constant, whose text is there."""
    for module, loaded in sorted(sys.modules.items()):
        file = getattr(loaded, "__file__", None)
        if (
            module.startswith("quietarm.")
            and file
            and re.search(
                rf"^(\w+, )*{name}(:| =|, )", Path(file).read_text(encoding="utf-8"), re.MULTILINE
            )
        ):
            return module
    raise ValueError(f"{name} is defined nowhere")


def _fill(app, docname, source):
    """Put every command, or every public name, on its page."""
    if docname == "docs/commands":
        for name in COMMANDS:
            own = "list_" if name == "list" else name
            command = f"quietarm.studies.cli.commands.{name}_command:{own}"
            directive = f".. click:: {command}\n   :prog: quietarm {name}"
            source[0] += f"\n```{{eval-rst}}\n{directive}\n```\n"
    if docname.startswith("docs/reference/"):
        package = Path(docname).name
        rooms = _ROOMS.get(package, {})
        source[0] += _reference(package)
        for name, title in rooms.items():
            source[0] += f"\n## {title}\n{_reference(f'{package}.{name}')}"


def _reference(package):
    """What autodoc is asked for all public names of a package that are no rooms."""
    module = import_module(f"quietarm.{package}")
    public = {name for name in module.__all__ if not ismodule(getattr(module, name))}
    names = sorted(public - {"__version__"}, key=str.lower)
    described = "".join(_described(package, name, getattr(module, name)) for name in names)
    return f"\n```{{eval-rst}}\n{described}```\n"


def _as_code(app, ctx, lines):
    """Set a command's examples as code: sphinx-click makes verse of what click leaves unwrapped."""
    for k in reversed(range(len(lines))):
        if lines[k].startswith("|   "):
            lines[k] = f"  {lines[k]}".replace("|", "", 1)
        elif lines[k].startswith("| "):
            lines[k : k + 1] = [lines[k][2:], "", ".. code-block:: text", ""]


def _options_as_typed(app, ctx, lines):
    """Show defaults without quotes, none where click's mark says so, and addresses as code."""
    shown = [line for line in lines if "Sentinel.UNSET" not in line]
    typed = [re.sub(r"(:default: ``)'(.*)'``", r"\1\2``", line) for line in shown]
    lines[:] = [re.sub(r"tcp://\w+:\d+", r"``\g<0>``", line) for line in typed]


def _no_arguments(app, ctx, lines):
    """Leave arguments to the line of usage: click has no words about them."""
    lines.clear()


def _write_front(app):
    """Write the page to drag along fronts, which stands in a frame of several pages.

    It is made with the site, so that it is never older than what it shows.
    """
    if app.builder.format != "html":
        return
    folder = Path(app.outdir, "docs")
    folder.mkdir(parents=True, exist_ok=True)
    page_of_fronts().save(folder / "front.html")
    # and the pages that notebooks show
    notebooks = Path(app.outdir, "notebooks")
    notebooks.mkdir(exist_ok=True)
    for page in Path(app.srcdir, "notebooks").glob("*.html"):
        shutil.copy(page, notebooks)


def setup(app):
    """Equations as MathML, and the pages that are made here."""
    app.add_html_math_renderer(
        "mathml", inline_renderers=(_inline, None), block_renderers=(_display, None)
    )
    app.connect("builder-inited", _write_front)
    app.connect("source-read", _fill)
    app.connect("sphinx-click-process-description", _as_code)
    app.connect("sphinx-click-process-options", _options_as_typed)
    app.connect("sphinx-click-process-arguments", _no_arguments)
