"""Pages hold what they were given, escaped, and nothing that a browser would fetch or run."""

from __future__ import annotations

import base64
from html.parser import HTMLParser

import pytest

from gearmath.page import Page

NASTY = '<script>alert("1")</script> & "\'>'


class Seen(HTMLParser):
    """All tags with their attributes, and all text."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.text = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in ("meta", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data


@pytest.fixture
def page() -> Page:
    page = Page(f"title {NASTY}")
    page.heading(f"heading {NASTY}")
    page.paragraph(f"paragraph {NASTY}")
    page.paragraph("careful", warning=True)
    page.table(f"caption {NASTY}", ["name", f"head {NASTY}"], [["a", "-1.5"], [f"cell {NASTY}", "2"], ["none", ""]])
    page.picture(b"\x89PNG and so on", f"picture {NASTY}")
    return page


def test_free_text_is_shown_and_never_becomes_markup(page):
    seen = Seen(page.html)
    assert seen.open == []
    for what in ("title", "heading", "paragraph", "caption", "head", "cell", "picture"):
        assert f"{what} {NASTY}" in seen.text
    frame, content = (
        {"html", "head", "meta", "title", "style", "body"},
        {"h1", "h2", "p", "figure", "img", "figcaption"},
    )
    assert {tag for tag, _ in seen.tags} == frame | content | {"table", "caption", "tr", "th", "td"}


def test_nothing_is_fetched_and_the_picture_is_inside(page):
    seen = Seen(page.html)
    (image,) = (attributes for tag, attributes in seen.tags if tag == "img")
    assert image["alt"] == f"picture {NASTY}"
    kind, data = image["src"].split(",")
    assert kind == "data:image/png;base64"
    assert base64.b64decode(data) == b"\x89PNG and so on"
    assert not any("href" in attributes or "http:" in str(attributes) for _, attributes in seen.tags)


def test_columns_of_numbers_stand_to_the_right(page):
    cells = [attributes for tag, attributes in Seen(page.html).tags if tag in ("td", "th")]
    assert cells == [{}, {"class": "number"}] * 4
