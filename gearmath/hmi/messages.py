"""What the page says, in English and German, from one file: ``messages.toml``, a table a page."""

from __future__ import annotations

from gearmath.hmi.language_files import language_file
from gearmath.hmi.reasons import english, german

LANGUAGES = {"en": "English", "de": "Deutsch"}


class Text:
    """The messages of one language: ``text("machine.channel")``, ``text("measure.point", point=3)``."""

    def __init__(self, language: str) -> None:
        self.language = language if language in LANGUAGES else "en"

    def __call__(self, key: str, **values: object) -> str:
        """A message with its values. Raises KeyError for a key that the file does not have."""
        page, _, name = key.partition(".")
        message = messages()[page][name][self.language]
        return message.format(**values) if values else message

    def quoted(self, words: object) -> str:
        """A sentence of the library, in German where its German is known, or of the control: what stays English on a
        German page is said to be so. Nothing of nothing."""
        said = str(words)
        known = german(said) if self.language == "de" else None
        return known or (self("shell.quoted", words=english(said)) if said else "")

    def has(self, key: str) -> bool:
        """Whether there is a message of this key: words of a control or a file may have none."""
        page, _, name = key.partition(".")
        return name in messages().get(page, {})


def messages() -> dict[str, dict[str, dict[str, str]]]:
    """By page, name and language."""
    return language_file("messages.toml")
