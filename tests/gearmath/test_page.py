"""Pages hold what they were given, escaped, and nothing that a browser would fetch or run."""

from __future__ import annotations

from html.parser import HTMLParser

import pytest

from gearmath.page import Page

#: As matplotlib writes it: names, and references to them.
SVG = '<svg viewBox="0 0 2 1"><defs><path id="m1"/></defs><use xlink:href="#m1" clip-path="url(#m1)"/></svg>'
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
        if tag != "meta":
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

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
    page.subheading(f"subheading {NASTY}")
    page.first(f"frame {NASTY}", [f"sentence {NASTY}"])
    page.head(["one", f"column {NASTY}"], [(f"label {NASTY}", [f"value {NASTY}", ""])])
    page.drawings([(SVG, f"drawing {NASTY}"), (SVG, "another")])
    return page


def test_free_text_is_shown_and_never_becomes_markup(page):
    seen = Seen(page.html)
    assert seen.open == []
    words = (
        "title",
        "heading",
        "paragraph",
        "caption",
        "head",
        "cell",
        "subheading",
        "frame",
        "sentence",
        "column",
        "label",
        "value",
        "drawing",
    )
    for what in words:
        assert f"{what} {NASTY}" in seen.text
    frame = {"html", "head", "meta", "title", "style", "body", "div"}
    content = {"h1", "h2", "h3", "p", "ul", "li", "figure", "figcaption", "table", "caption", "thead", "tr", "th", "td"}
    assert {tag for tag, _ in seen.tags} == frame | content | {"svg", "defs", "path", "use"}


def test_nothing_is_fetched_and_drawings_are_inside_each_with_its_own_names(page):
    seen = Seen(page.html)
    assert not any(name in attributes for _, attributes in seen.tags for name in ("src", "href", "onload"))
    assert "http" not in page.html.replace("http-equiv", "")
    assert [a["aria-label"] for tag, a in seen.tags if tag == "svg"] == [f"drawing {NASTY}", "another"]
    names = [a["id"] for _, a in seen.tags if "id" in a]
    assert len(names) == len(set(names)) == 2
    references = [(a["xlink:href"], a["clip-path"]) for tag, a in seen.tags if tag == "use"]
    assert references == [(f"#{name}", f"url(#{name})") for name in names]


def test_what_is_not_known_at_the_head_is_left_to_fill_in(page):
    seen = Seen(page.html)
    head = page.html[page.html.index('<table class="head">') :]
    assert "<td></td>" in head[: head.index("</table>")]
    assert seen.open == []


def test_columns_of_numbers_stand_to_the_right(page):
    table = page.html[page.html.index("<caption>") : page.html.index("</table>")]
    cells = [attributes for tag, attributes in Seen(table).tags if tag in ("td", "th")]
    assert cells == [{}, {"class": "number"}] * 4
