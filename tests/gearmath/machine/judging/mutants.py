"""Programs with one thing wrong in them, and who sees it: of a SINUMERIK and of LinuxCNC."""

from __future__ import annotations

import re
from collections import Counter

import numpy as np

MOTION = re.compile(r"[XYZ][-0-9]")


def digits(line):
    """The line with one digit or the sign of one axis, S or F word changed, in every way, with what it is."""
    for word in re.finditer(r"(?:(?<!\S)[XYZABCSF]|[AC]=DC\()(-?)([0-9.]+)", line):
        kind = "F" if word[0][0] == "F" else "S" if word[0][0] == "S" else "axis"
        for at in range(word.start(2), word.end(2)):
            for digit in "0123456789" if line[at].isdecimal() else "":
                if digit != line[at]:
                    yield f"{kind} digit", line[:at] + digit + line[at + 1 :]
        if kind == "axis":
            yield "sign", line[: word.start(1)] + ("" if word[1] else "-") + line[word.start(2) :]


def others(whole):
    """Whole texts with one block wrong otherwise: kind, line from 1, and the lines in its place."""
    for k, line in enumerate(whole.lines):
        if not line or line.startswith(";"):
            continue
        yield "removed block", k + 1, []
        yield "doubled block", k + 1, [line, line]
        if "MSG(" in line or line.startswith(("(", "o")):  # what is said, and what LinuxCNC asks
            continue
        for right, wrong, kind in (
            ("G0", "G1", "G0 for G1"),
            ("G1", "G0", "G1 for G0"),
            ("M3", "M4", "M3 for M4"),
            ("G54", "G55", "G54 for G55"),
        ):
            if re.search(rf"\b{right}\b", line):
                yield kind, k + 1, [re.sub(rf"\b{right}\b", wrong, line)]
        if not MOTION.search(line) and re.search(r"[SF][0-9]", line):
            for kind, wrong in digits(line):
                yield kind, k + 1, [wrong]
        if " G93 " not in line and "MSG(" not in line and "IF" not in line:
            words = line.split()
            for j in range(1, len(words)):
                yield "removed word", k + 1, [" ".join(words[:j] + words[j + 1 :])]


def wrong_digits(whole, blocks, per_block, random):
    """Digits and signs of motion blocks: kind, line and the lines in its place."""
    chosen = [line for line in whole.path.line.tolist() if MOTION.search(whole.lines[line - 1])]
    if blocks < len(chosen):
        chosen = np.sort(random.choice(chosen, blocks, replace=False)).tolist()
    for line in chosen:
        found = list(digits(whole.lines[line - 1]))
        some = range(len(found)) if per_block >= len(found) else random.choice(len(found), per_block, replace=False)
        yield from ((found[j][0], line, [found[j][1]]) for j in some)


def sample_of(found, count, random):
    found = list(found)
    return [found[j] for j in np.sort(random.choice(len(found), min(count, len(found)), replace=False))]


def trial(whole, dense, changed):
    """How many changes of each kind are refused or seen, and how many harmless; and those that nobody sees."""
    count, unseen = Counter(), []
    seen, open_ = whole.alone([(line, new) for _, line, new in changed])
    seen |= {mutant for mutant in open_ if whole.faults(whole.with_lines(*changed[mutant][1:]))}
    asked = [mutant for mutant in range(len(changed)) if mutant not in seen]
    told = dense.harms_of_ends([changed[mutant][1:] for mutant in asked])
    harms = {mutant: told[k] if k in told else dense.harm_of(*changed[mutant][1:]) for k, mutant in enumerate(asked)}
    for mutant, (kind, line, new) in enumerate(changed):
        if mutant in seen:
            count[kind, "seen"] += 1
        elif (harm := harms[mutant]) is None:
            count[kind, "harmless"] += 1
        elif whole.spoils(line, new) or whole.faults(whole.with_lines(line, new), everything=True):
            count[kind, "seen"] += 1
        else:
            unseen.append((kind, harm, f"line {line}: {whole.lines[line - 1]} -> {' | '.join(new)}"))
    return count, unseen
