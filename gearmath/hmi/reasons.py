"""What the library says of a failure, in German: part by part, by the patterns of ``reasons.toml``.

The library speaks English, to people and to other programs; its sentences name file, key, value and limit, with ": "
and "; " between the parts. What has no pattern stays English as a whole: half a sentence in each language helps nobody.
"""

from __future__ import annotations

import functools
import re
import string

from gearmath.hmi.language_files import language_file

_BETWEEN = re.compile(r"(: |; )")
_QUOTED = re.compile(r"'[^']*'|\"[^\"]*\"")
#: A word that may be one of a sentence: what holds a digit, a sign or a capital is a name, a number or a unit.
_WORD = re.compile(r"[a-z]+")
_UNITS = {"mm", "min", "s", "x", "kB", "mm/min", "h"}
#: Words that no title has.
_SENTENCE = {"the", "a", "an", "is", "are", "was", "has", "have", "must", "not", "no", "be", "to", "of"}
#: So many parts of a sentence are looked at; a longer one is a list of faults of a program.
_MOST = 12


@functools.lru_cache(maxsize=1000)
def german(sentence: str) -> str | None:
    """The sentence in German, its names and numbers as they are; None where a part of it is not known."""
    parts = _BETWEEN.split(sentence.strip(), maxsplit=_MOST)
    for k in range(len(parts), 0, -2):  # the longest beginning that is known
        begin = _part("".join(parts[:k]))
        if begin is None:
            continue
        if k == len(parts):
            return begin
        rest = german("".join(parts[k + 1 :]))
        if rest is not None:
            return begin + parts[k] + rest
    return None


def english(sentence: str) -> str:
    """The sentence without the options of a command, which a page does not have."""
    for option, words in language_file("reasons.toml")["page"].items():
        sentence = sentence.replace(option, words)
    return sentence


def _part(words: str) -> str | None:
    for pattern, translated in _patterns():
        found = pattern.fullmatch(words)
        if found is None:
            continue
        values = {name: _value(value) for name, value in found.groupdict().items()}
        if None not in values.values():
            return translated.format(**values)
    return None if _BETWEEN.search(words) else _name(words)


def _value(words: str) -> str | None:
    if _BETWEEN.search(f"{words} "):  # a pattern names all the parts that it goes over
        return None
    return _part(words)


def _name(words: str) -> str | None:
    """Names, numbers and units, known words among them in German; None for words of a sentence."""
    known, kept = language_file("reasons.toml")["words"], _QUOTED.findall(words)
    found: list[str] = []
    left = [part for part in _QUOTED.sub("'", words).split(" ") if part]
    if not left:
        return None
    if left[0][0].isupper() and _SENTENCE.isdisjoint(left):  # a title, such as that of a machine
        return words
    k = 0
    while k < len(left):
        size = next((n for n in (4, 3, 2) if " ".join(left[k : k + n]).rstrip(",") in known), 1)
        token = " ".join(left[k : k + size])
        bare = token.strip(",()")
        is_key = k + size < len(left) and left[k + size] == "="
        if bare in known:
            found.append(token.replace(bare, known[bare]))
        elif _WORD.fullmatch(bare) and bare not in _UNITS and not is_key and len(left) > 1:
            return None
        else:
            found.append(_setting(token))
        k += size
    joined = " ".join(found)
    for one in kept:
        joined = joined.replace("'", one.replace("'", "\0"), 1)
    return joined.replace("\0", "'")


def _setting(token: str) -> str:
    """``pinion.concave.blade_edge_radius`` as the page calls it; anything else as it is."""
    *places, key = token.split(".")
    words, gear = language_file("reasons.toml")["words"], language_file("messages.toml")["gear"]
    if key not in gear or not all(place in words or place == "blank" for place in places):
        return token
    names = [words[place] for place in places if place in words]
    return ", ".join([gear[key]["de"], *names])


@functools.cache
def _patterns() -> list[tuple[re.Pattern[str], str]]:
    """Each with its German, the one that says most first."""
    found = []
    for english, translated in language_file("reasons.toml")["reasons"].items():
        literal, pattern = 0, ""
        for text, name, _, _ in string.Formatter().parse(english):
            literal += len(text)
            pattern += re.escape(text)
            if name is not None:
                pattern += f"(?P<{name}>.+?)"
        found.append((literal, re.compile(pattern, re.DOTALL), translated))
    return [(pattern, translated) for _, pattern, translated in sorted(found, key=lambda one: -one[0])]
