"""Probing and calibration programs with one word wrong: each is refused, or seen, or does what the right one does.

What passes the judge is compared with the right program by what it does, run as a control would in states that the
judge does not choose: parts of the program, a probe that fails somewhere, a control that is set up wrong. Motion must
be as guarded and as slow, and end where the right one ends, or higher, or nowhere near what there is, by plain
distances; what is written must be the same within a tenth of a millimetre.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from gearmath.errors import ComputationError, InputError
from gearmath.machine.control.executor import run_program
from gearmath.machine.control.state import Setup
from gearmath.machine.measuring.artefacts import Artefacts
from gearmath.machine.measuring.collision_check import approaches
from gearmath.machine.measuring.judge import judge_calibration, judge_probing
from gearmath.machine.measuring.probe_run import run_touches
from gearmath.machine.writing.axis_cycle import axis_program
from gearmath.machine.writing.calibrating import calibration_program
from gearmath.machine.writing.probing import probing_program
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.calibration import load_calibration
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
PROBE = load_calibration(bundled("probe.toml"))
RING = PROBE.model_copy(update={"sphere": None})
SET = load_bevel_set(bundled("nasa_tp3096_12x36.toml"))
RIGHT = Setup.of(MACHINE, PROBE.length)
#: Lines of touches may differ by this in their positions. [mm, degree]
ALIKE = 0.1, 0.06
#: The face of the ring may be touched so far [mm] from the middle of its wall, with the tip still on it.
FLAT = PROBE.ring.face.width / 2 - PROBE.tip_radius

PROGRAMS = {
    "pitch": lambda: probing_program(SET, "pinion", MACHINE, PROBE, "TT", topography=()),
    "repeated": lambda: probing_program(SET, "pinion", MACHINE, PROBE, "TT", topography=(), repeat=2),
    "ring": lambda: calibration_program(MACHINE, RING, "TT"),
    "tip": lambda: calibration_program(MACHINE, PROBE, "TT"),
    "axes": lambda: axis_program(MACHINE, PROBE, "TT"),
}

OPERATORS = {"<>": "==", "==": "<>", ">=": ">", "<=": "<", ">": "<", "<": ">", " AND ": " OR ", " OR ": " AND "}


def mutants(line, random):
    """One numbered line with one thing wrong, in every way but for digits: kind and the lines in its place."""
    yield "removed block", []
    yield "doubled block", [line, line]
    words = line.split(" ")
    if '"' not in line:
        for j in range(1, len(words)):
            yield "removed word", [" ".join(words[:j] + words[j + 1 :])]
    start = line.index(" ") + 1 if " " in line else len(line)
    code = re.sub(r'"[^"]*"', lambda text: "#" * len(text[0]), line)  # texts are not code
    for found in re.finditer(r"<>|==|>=|<=|<<|>|<| AND | OR ", code):
        if found[0] in OPERATORS:
            yield "operator", [line[: found.start()] + OPERATORS[found[0]] + line[found.end() :]]
    for found in re.finditer(r"\bG0\b|\bG1\b", code):
        other = "G1" if found[0] == "G0" else "G0"
        yield "G0 for G1", [line[: found.start()] + other + line[found.end() :]]
    for found in re.finditer(r"\[([XYZAB])\]|(?<![A-Z])([XYZAB])(?==|-?[0-9])", code):
        at = found.start(1) if found[1] else found.start(2)
        for letter in random.choice([axis for axis in "XYZAB" if axis != line[at]], 1):
            yield "axis letter", [line[:at] + letter + line[at + 1 :]]
    for found in re.finditer(r"[-+](?=[0-9A-Z(])|(?<=[=( XYZAB])(?=[0-9])", code):
        if found.start() >= start:
            sign = {"-": "+", "+": "-", "": "-"}[found[0]]
            yield "sign", [line[: found.start()] + sign + line[found.end() :]]
    for found in re.finditer(r"[0-9]+", code):
        if found.start() < start:
            continue
        for at in range(found.start(), found.end()):
            digit = random.choice([d for d in "0123456789" if d != line[at]])
            yield "digit", [line[:at] + digit + line[at + 1 :]]
    if (text := re.search(r'"([^"]*)"', line)) and ("WRITE" in line or "T=" in line or "DELETE" in line):
        at = int(random.integers(text.start(1), max(text.end(1), text.start(1) + 1)))
        yield "letter of a text", [line[:at] + ("x" if line[at] != "x" else "y") + line[at + 1 :]]


def ends(start, end):
    """A probe that triggers on the ways along a flank, half a millimetre before their ends."""
    x, y, z, a, b = np.abs(end - start)
    return end if max(x, y) > 1e-7 and z > 1e-7 and max(a, b) <= 1e-7 else None


class Trace:
    """What a program does: kind, end, feed of its blocks; lines of its file; whether it set an alarm."""

    def __init__(self, text, probe, setup=RIGHT, parameters=None, fails=None, deflected=None, delay=None):
        self.blocks, self.refused, self.waits = [], False, 0
        calls = looks = 0

        def touch(start, end):
            nonlocal calls
            calls += 1
            self.commanded = end.copy()
            met = probe(start, end)
            if calls == fails:
                met = None if met is not None else start + 0.3 * (end - start)
            self.ways.append((start.copy(), end.copy(), met))
            return met

        def is_deflected(position):
            nonlocal looks
            looks += 1
            return looks == deflected

        def host(given):
            self.waits += 1
            return {103: given.get(101, 0.0)} if delay is None or self.waits % delay == 0 else {}

        self.ways = []
        try:
            done = run_program(
                text,
                "T",
                touch,
                host,
                parameters or {},
                setup=setup,
                deflected=is_deflected,
                files={"TT_T": "old\n"},
                step_limit=200_000,
            )
        except InputError:
            self.refused = True
            return
        path, n = done.path, 0
        self.alarm = done.alarm is not None
        self.lines = [line for text in done.files.values() for line in text.splitlines()]
        self.halted = [(halt.stop, halt.rows) for halt in path.halts if halt.stop]
        self.blind = [(one.raised, one.z) for one in path.blind]
        for k in range(len(path.line)):
            end = path.axes[k]
            if path.measuring[k]:
                end, n = self.ways[n][1], n + 1
            first = path.axes[k - 1] if k else end
            way = np.linalg.norm([*(end - first)[:3], *np.degrees(end - first)[3:]])
            still = way < 1e-3 or not path.seconds[k]
            feed = 0.0 if path.rapid[k] or still else way / path.seconds[k] * 60.0
            kind = "M" if path.measuring[k] else "R" if path.rapid[k] else "G"
            self.blocks.append((kind, first, end, path.axes[k], feed))


def differs(one, right, free):
    """How a trace is worse than the right one, or None."""
    if one.refused or right.refused:
        return None if one.refused else "is not refused"
    if right.alarm and not one.alarm:
        return "alarm"
    if one.alarm and not right.alarm:
        return None  # it stops: seen on the machine, nothing is lost
    if right.alarm and len(one.blocks) <= len(right.blocks):
        return None
    if one.halted[:1] != right.halted[:1] or one.waits < right.waits or one.blind != right.blind:
        return "stops, waits, blind moves"
    if not alike_kinds(one.blocks, right.blocks):
        moving = ([b for b in blocks if np.abs(b[2] - b[1]).max() > 1e-9] for blocks in (one.blocks, right.blocks))
        if not alike_kinds(*moving):
            return "kinds of blocks"
    for (kind, first, end, real, feed), (_, _, wanted, _, slow) in zip(one.blocks, right.blocks, strict=False):
        off = end - wanted
        off[3:] = np.degrees((off[3:] + np.pi) % (2 * np.pi) - np.pi)
        if feed > max(slow, 0.0 if kind == "M" else 800.0) * 1.002 and kind != "R":
            return "feed"
        near = np.abs(off[:3]).max() <= ALIKE[0] and np.abs(off[3:]).max() <= ALIKE[1]
        higher = off[2] > 0.0 and np.abs(np.delete(off, 2)).max() < 1e-6
        if not near and not higher and not free(kind, first, real):
            return f"position {np.round(off, 3)}"
    return lines_differ(one.lines, right.lines)


def alike_kinds(one, right):
    """The same kinds of blocks; but to go in feed where the right program goes in rapid is no harm."""
    pairs = zip(one, right, strict=False)
    return len(one) == len(right) and all(a[0] == b[0] or (a[0], b[0]) == ("G", "R") for a, b in pairs)


def lines_differ(one, right):
    if len(one) != len(right):
        return "number of lines"
    for a, b in zip(one, right, strict=True):
        cells, wanted = a.split(","), b.split(",")
        if len(cells) != len(wanted):
            return "cells"
        for cell, want in zip(cells, wanted, strict=True):
            if cell == want:
                continue
            try:
                off = float(cell) - float(want)
            except ValueError:
                return f"line {a}"
            if "ring_face" in wanted and cell in cells[3:5] and abs(off) < FLAT:
                continue  # the face is flat
            if "." not in want + cell or min(abs(off), abs(abs(off) - 360.0)) > ALIKE[0]:
                return f"line {a} for {b}"
    return None


class Judged:
    """One right program, and how a changed one is judged and compared."""

    def __init__(self, name):
        self.name, self.text = name, PROGRAMS[name]()
        self.lines = self.text.split("\n")
        self.member = name in ("pitch", "repeated")
        self.probe = RING if name == "ring" else PROBE
        self.scenes = self._scenes(np.random.default_rng(5))
        self.right = [self.trace(self.text, scene) for scene in self.scenes]

    def _scenes(self, random):
        whole = Trace(self.text, self._there())
        ways, parts = len(whole.ways), {"pitch": 26, "repeated": 26, "ring": 2, "tip": 3, "axes": 9}[self.name]
        first = int(random.integers(1, parts + 1))
        wrong = [
            replace(RIGHT, offset=(0, 0, 0.3, 0, 0)),
            replace(RIGHT, mirrored=(0, 0, 1)),
            replace(RIGHT, metric=False),
            replace(RIGHT, turned=(1.0, 0, 0)),
            replace(RIGHT, scaled=(1, 1, 1.01)),
            replace(RIGHT, offset=(0.2, 0, 0, 0, 0)),
            replace(RIGHT, offset=(0, 0, 0, 0, 0.1)),
            replace(RIGHT, spindle_tool=lambda wanted: "CUTTER"),
            replace(RIGHT, probe_length=12.0),
            replace(RIGHT, increments=(1000, 1e9)),
            replace(RIGHT, increments=(1e9, 1000)),
            replace(RIGHT, result_file_kB=0.3),
        ]
        return [
            {},
            {"parameters": {90: first, 91: int(random.integers(first, parts + 1))}},
            {"parameters": {90: parts, 91: 0}},
            {"parameters": {90: parts + 1}},
            {"parameters": {104: 1}, "delay": 3},
            *({"fails": int(k)} for k in random.choice(np.arange(1, ways + 1), 3, replace=False)),
            *({"deflected": int(k)} for k in random.choice(np.arange(1, ways + 1), 3, replace=False)),
            *({"setup": one} for one in wrong),
        ]

    def _there(self):
        return ends if self.member else Artefacts(MACHINE, self.probe)

    def trace(self, text, scene):
        return Trace(text, self._there(), **scene)

    def seen(self, text):
        try:
            if self.member:
                return bool(judge_probing(text, "T", SET.pinion, MACHINE, PROBE))
            return bool(judge_calibration(text, "T", MACHINE, self.probe))
        except (InputError, ComputationError):
            return True

    def harm(self, text, line=0):
        """What a program that passes does worse; None where it does no harm."""
        deep = None

        def free(kind, first, end):
            nonlocal deep
            if self.member:  # tip, stylus and spindle against the whole member
                if deep is None:
                    try:
                        deep = min(
                            a.distance for a in approaches(text, "T", SET.pinion, MACHINE, PROBE, MACHINE.fixture)
                        )
                    except InputError:
                        return True  # it stops on the nominal member, and gearmath probe says so
                return deep > 0.0
            way = first + np.linspace(0, 1, 200)[:, None] * (end - first)
            return self._clear(way[:-1] if kind == "M" else way)

        for scene, right in zip(self.scenes, self.right, strict=True):
            if found := differs(self.trace(text, scene), right, free):
                return found, {k: v for k, v in scene.items() if k != "setup"}
        return None

    def _clear(self, way):
        """Whether the tip is out of ring and sphere, by plain distances; nothing is known of the sphere on the work."""
        tip, r = way[:, :3], self.probe.tip_radius
        if self.name == "axes":
            return False
        sphere, ring = self.probe.sphere, self.probe.ring
        if sphere and (np.linalg.norm(tip - sphere.center, axis=1) < sphere.diameter / 2 + r - 2e-3).any():
            return False
        off = np.linalg.norm(tip[:, :2] - ring.center[:2], axis=1)
        low = tip[:, 2] - r < ring.face.seat + ring.face.height - 2e-3
        wall = (off > ring.diameter / 2 - r + 2e-3) & (off < ring.diameter / 2 + ring.face.width + r)
        return not (low & wall).any()


def trial(judged, chosen):
    """Counts by kind, and those that nobody sees and that do harm."""
    count, unseen = Counter(), []
    for kind, line, new in chosen:
        text = "\n".join([*judged.lines[: line - 1], *new, *judged.lines[line:]])
        if judged.seen(text):
            count[kind, "seen"] += 1
        elif (harm := judged.harm(text)) is None:
            count[kind, "harmless"] += 1
        else:
            unseen.append((kind, harm, f"line {line}: {judged.lines[line - 1]} -> {' | '.join(new)}"))
    return count, unseen


def all_of(judged, random):
    for number, line in enumerate(judged.lines, 1):
        if line.startswith("N"):
            yield from ((kind, number, new) for kind, new in mutants(line, random))


#: Mutants in CI of each program; the others were tried once, as the commit message counts.
SAMPLED = {"pitch": 25, "ring": 40}


@pytest.mark.slow
@pytest.mark.parametrize("name", SAMPLED)
def test_no_wrong_word_of_a_probing_program_is_left_unseen(name):
    judged, random = Judged(name), np.random.default_rng(11)
    assert not judged.seen(judged.text)
    found = list(all_of(judged, random))
    chosen = [found[k] for k in np.sort(random.choice(len(found), SAMPLED[name], replace=False))]
    count, unseen = trial(judged, chosen)
    kinds = sorted({kind for kind, _ in count})
    print(f"\n{name}: {len(chosen)} of {len(found)} mutants, {len(unseen)} unseen; refused or seen + harmless:")
    print("; ".join(f"{kind} {count[kind, 'seen']} + {count[kind, 'harmless']}" for kind in kinds))
    assert unseen == []
    assert sum(count[kind, "seen"] for kind in kinds) > len(chosen) / 3


@pytest.mark.parametrize("name", PROGRAMS)
def test_right_program_has_no_faults_and_does_no_harm(name):
    if name == "axes":  # of the work sphere the dense check knows nothing
        assert judge_calibration(PROGRAMS[name](), "T", MACHINE, PROBE) == []
        return
    judged = Judged(name)
    assert not judged.seen(judged.text)
    assert judged.harm(judged.text) is None


def faults(text):
    try:
        return [str(one) for one in judge_probing(text, "T", SET.pinion, MACHINE, PROBE)]
    except (InputError, ComputationError) as error:
        return [str(error)]


@pytest.mark.parametrize(
    ("pattern", "wrong", "sentence"),
    [
        (r"F100\.000", "F900.000", r"line \d+ touches at 900 mm/min, at most 100 are allowed"),
        (r"(Z=UWAY\[UPLACE,2\] .*) F800\.000", r"\1 F2500.000", r"moves the probe at 2500 mm/min, at most 800 are"),
        (r"F3000\.000", "F8000.000", r"moves the probe at \d+ mm/min, at most 3000 are allowed"),
        (r"FGREF\[A\]=57\.29578", "FGREF[A]=5.729578", r"moves the probe at \d+ mm/min, at most 3000 are allowed"),
        (
            r"MEAS=1 G1 X=UWAY\[UPLACE,0\]",
            "G1 X=UWAY[UPLACE,0]",
            r"line \d+ moves without MEAS where the probe could|65002",
        ),
        (
            r"G1 (X=UWAY\[UPLACE,0\] Y=UWAY\[UPLACE,1\] Z\S+) F800",
            r"G0 \1 F800",
            r"line \d+ moves in rapid where the pro",
        ),
        (
            r"IF \$A_PROBE\[1\]<>0\n.*\nSETAL\(65000\)\nM30\nENDIF\n(?=MEAS=1 G1 X=UWAY)",
            "",
            r"line \d+ measures without a look at \$A_PROBE",
        ),
        (r"IF \$A_PROBE\[1\]<>0(\n(?:.*\n)*?.*ENDIF\nMEAS)", r"IF $A_PROBE[1]<>1\1", r"sets alarm|ends with alarm"),
        (r"(SETAL\(65001\)\n)M30\n", r"\1", r"line \d+ does not stop the program where nothing is touched"),
        (r"(SETAL\(65002\)\n)M30\n", r"\1", r"line \d+ does not stop the program where something is touched too early"),
        (r"IF R205==0", "IF R205==2", r"line \d+ does not stop the program where nothing is touched"),
        (r"R200=\$AA_MM\[X\]", "R200=$AA_MM[Y]", r"is not written with the position at which the probe met it"),
        (r'<<R200<<","<<R201', '<<R201<<","<<R200', r"is not written with the position at which the probe met it"),
        (r"pinion,concave", "pinion,convex", r"is written as touch \d+: it lies \d"),
        (r"pinion,concave", "gear,concave", r"is written as touch \d+: there is no such place"),
        (r"UPOINT>=UFROM", "UPOINT>UFROM", r"plans 26 touches, makes 25 and writes 25"),
        (r"UPOINT<=UTO", "UPOINT<=UTO+1", r"with R90=2 R91=2 does not make part 2 of the run, and that alone"),
        (r"R101=\(UFROM-1\)\*1", "R101=UFROM*1", r"with R90=\d does not write which touches it makes: points: 2 to 2"),
        (r"IF UFROM==1", "IF UFROM>=1", r"with R90=2 loses the touches that were made before"),
        (r"IF UFROM==1", "IF UFROM==2", r"with R90=1 adds to the file of the last run"),
        (r"M0\n", "", r"with R90=1 moves before it has waited at M0 for the operator"),
        (r"WHILE R103<>R101", "WHILE R103>R101", r"does not wait for a host that does not answer"),
        (r"IF R104==1", "IF R104==2", r"does not wait for a host that does not answer"),
        (r"IF R104==1", "IF R50==1", r"reads R50 before it sets it"),
        (r"POINTS:\n", "POINTS:\nIF $AA_IM[X]>10\nG4 F1\nENDIF\n", r"goes on in one way or another by \$AA_IM\[X\]"),
        (
            r"IF \$MN_LEN_PROTOCOL_FILE<\d+",
            "IF $MN_LEN_PROTOCOL_FILE<0",
            r"where the control allows no result file that is lo",
        ),
        (r'T="PROBE"', 'T="PROBF"', r'moves the tool "PROBF", the probe is "PROBE"|alarm 65013'),
        (r"G0 SUPA Z900\.00000\n(?=D1)", "", r"moves before Z has gone up to \d+\.\d mm|Z"),
        (
            r"G0 SUPA Z900\.00000\n(?=T=)",
            "",
            r"line \d+ changes the tool before Z has gone up to \d+\.\d mm or more with SUPA",
        ),
        (r"G0 SUPA Z900\.00000", "G0 SUPA Z900.60000", r"line \d+ moves Z to 900\.600 mm"),
        (r"26 touches", "27 touches", r"plans 27 touches, makes 26 and writes 26"),
    ],
)
def test_what_a_probing_program_must_not_do_is_said(pattern, wrong, sentence):
    plain = re.sub(r"(?m)^N\d+ ", "", PROGRAMS["pitch"]())
    changed, found = re.subn(pattern, wrong, plain, flags=re.MULTILINE)
    assert found
    said = faults(changed)
    assert any(re.search(sentence, one) for one in said), said


@pytest.mark.parametrize(
    ("pattern", "wanted"),
    [
        (r"F100\.000", "F80."),
        (r"F3000\.000", "F2500"),
        (r"^POINTS:$", "TEETH:"),
        (r"^STOPRE$", "STOPRE\nSTOPRE"),
        (r"^(SPOS=0)$", r"\1\nSPOS=0"),
        (r"^(SPOS=0)$", r"\1\nG4 F1"),
        (r"^(R101=R101\+1)$", r"\1\nR77=R101"),
        (r"^(R101=R101\+1)$", r'\1\nMSG("touched")'),
        (r"^(G0 Z\S+\nIF R205==0)", r"G4 F0.2\n\1"),
        (r"IF R205==0", "IF R205<>1"),
    ],
)
def test_what_does_no_harm_is_no_fault(pattern, wanted):
    plain = re.sub(r"(?m)^N\d+ ", "", PROGRAMS["pitch"]())
    changed, found = re.subn(pattern, wanted, plain, flags=re.MULTILINE)
    assert found
    assert faults(changed) == []


def test_probe_that_stays_at_the_flank_stays_deflected():
    """Without the way back after a touch the next look at the probe stops the program."""
    text = PROGRAMS["ring"]()
    back = re.sub(r"(?m)^(N\d+ G1 X=R10 Y=R11) F.*$", "", text)
    there = Artefacts(MACHINE, RING)
    assert len(run_touches(text, "T", there).splitlines()) == 12
    with pytest.raises(ComputationError, match=r"alarm 65000 \(the probe is deflected before it is moved\), after 1 "):
        run_touches(back, "T", there)
