"""Pictures for a page: SVG whose text stays text, in the language of the page."""

from __future__ import annotations

import itertools
import re
import threading
from collections.abc import Callable, Mapping

from matplotlib.figure import Figure

from gearmath.page import own_names
from gearmath.plot import svg

#: Whoever draws holds it: fonts and settings of matplotlib belong to the process, not to a figure.
PENCIL = threading.RLock()
_NUMBERS = itertools.count(1)
_TEXT = re.compile(r"(?<=>)[^<>]+(?=</text>)")


def drawn(make: Callable[[], Figure]) -> str:
    """A figure as ``<svg>``; any number of them may stand on one page. Called from any thread."""
    with PENCIL:
        found = svg(make())
    return named(found)


def named(found: str) -> str:
    """An ``<svg>`` whose names are of no other on the page."""
    return own_names(found, f"p{next(_NUMBERS)}-")


def translated(found: str, words: Mapping[str, str]) -> str:
    """An ``<svg>`` whose texts are as ``words`` has them: a text as a whole, a part of it between commas and colons, or
    a phrase of several words within it; others stay.
    """
    phrases = sorted((phrase for phrase in words if " " in phrase), key=len, reverse=True)

    def other(match: re.Match[str]) -> str:
        if match[0] in words:
            return words[match[0]]
        parts = [words.get(part, part) for part in re.split(r"([,;:] ?)", match[0])]
        text = "".join(parts)
        for phrase in phrases:
            text = text.replace(phrase, words[phrase])
        return text

    return _TEXT.sub(other, found)
