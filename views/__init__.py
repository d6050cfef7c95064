"""Views that a person sees or takes away: reports, pictures, films, a page, formats of files.

Rooms: `report` has the words and tables of answers, `pictures` draws them, `page` is dragged in a
browser, and `formats` are what controllers and other programs read.

Rooms: `report` has the words and tables of answers, `pictures` draws them, `page` is dragged in a
browser, and `formats` are what controllers and other programs read.
"""

from quietarm.loading import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
