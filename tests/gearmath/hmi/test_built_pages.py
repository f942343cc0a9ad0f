"""What pages say, without a browser."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from gearmath.hmi import gear_draft
from gearmath.hmi.messages import Text
from gearmath.hmi.state import Shared
from tests.gearmath.hmi.built import Built, build  # noqa: F401


def test_what_is_computed_is_named_in_the_language_of_who_looks_not_of_who_has_begun_it(
    build: Callable[..., Built],  # noqa: F811
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    shared, go_on = Shared(tmp_path / "runs.db"), threading.Event()
    known = gear_draft.draft
    monkeypatch.setattr(gear_draft, "draft", lambda *given: go_on.wait(60) and known(*given))
    said = {language: build(shared, "gear", language, wait=False).says() for language in ("en", "de")}
    go_on.set()
    for language, other in (("en", "de"), ("de", "en")):
        assert any(Text(language)("gear.judging") in one for one in said[language])
        assert not any(Text(other)("gear.judging") in one for one in said[language])
