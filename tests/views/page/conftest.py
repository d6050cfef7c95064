"""A browser for the tests of the page."""

from in_browser import chromium, open_page  # noqa: F401
