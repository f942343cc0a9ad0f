"""Blocks of POLY as their text has them, by words typed here, for the tests of both kinds of programs."""

import math
import re

import numpy as np

from gearmath.machine.control.reader import read_program
from gearmath.machine.control.tree import Block, Branch
from gearmath.machine.control.values import number
from gearmath.machine.writing.words import Positions

AXES = "XYZABC"
WORD = re.compile(r"(?:PO\[([XYZABC])\]=\(|([XYZABC])=PO\()([-0-9.,]+)\)")


def written_in(line):
    """The values of PO by axis."""
    return {a or b: [float(v) for v in values.split(",")] for a, b, values in WORD.findall(line)}


def along_blocks(start, blocks, u):
    """Positions (blocks, n, axes) in mm and degrees at parameters u (n,) of each block: x0 + a1 u + a2 u^2 ..

    ``start`` are five positions or six, and a block is what ``written_in`` gives, and its time.
    """
    here, found = start, []
    for written, _ in blocks:
        every = [written.get(axis, [x]) for axis, x in zip(AXES, here, strict=False)]  # an axis without a word stays
        ends = np.array([values[0] for values in every])
        higher = [np.array(values[1:]) for values in every]
        first = ends - here - np.array([a.sum() for a in higher])
        axes = [
            x + a1 * u + sum(a * u**k for k, a in enumerate(more, 2))
            for x, a1, more in zip(here, first, higher, strict=True)
        ]
        found.append(np.stack(axes, axis=1))
        here = ends
    return np.stack(found)


def written_again(text, name, machine, axes, degree):
    """For every block with PO what the writer makes of the numbers that the reader finds, and the line it is in."""
    positions, per_internal = (
        Positions.of(machine, machine.tool_length),
        np.array([1, 1, 1, *[180 / math.pi] * 3])[:axes],
    )
    lines = text.splitlines()
    for block in _blocks(read_program(text, name).body):
        ends, bends = np.zeros((2, axes)), np.zeros((1, axes, degree - 1))
        for k, axis in enumerate(AXES[:axes]):
            word = block.words[axis]
            ends[1, k] = number(word.value, None, "", 0, 0)
            bends[0, k, : len(word.coefficients)] = [number(a, None, "", 0, 0) for a in word.coefficients]
        (words,) = positions.polynomial_words(ends / per_internal, bends / per_internal[:, None])
        yield " ".join(words), lines[block.line - 1]


def _blocks(body):
    for part in body:
        if isinstance(part, Branch):
            yield from _blocks(part.then)
        elif isinstance(part, Block) and any(word.way == "PO" for word in part.words.values()):
            yield part
