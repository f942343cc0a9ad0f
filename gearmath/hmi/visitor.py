"""What one browser has chosen: language and look, in cookies of its own."""

from __future__ import annotations

from starlette.requests import HTTPConnection

from gearmath.hmi.messages import LANGUAGES

LANGUAGE, LOOK = "gearmath_language", "gearmath_look"


def language_of(request: HTTPConnection) -> str:
    """What the operator chose, or the first language of the browser that there is."""
    chosen = request.cookies.get(LANGUAGE, "")
    if chosen in LANGUAGES:
        return chosen
    asked = [part.split(";")[0].strip()[:2].lower() for part in request.headers.get("accept-language", "").split(",")]
    return next((one for one in asked if one in LANGUAGES), "en")


def is_dark(request: HTTPConnection) -> bool:
    """Whether the operator chose the dark look."""
    return request.cookies.get(LOOK) == "dark"
