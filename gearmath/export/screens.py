"""What the pages of the firmware's display mean: the chapters of the README about display and faults.

The labels are those of ``firmware/gm_screen.c``; a test compares them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from gearmath.export.display_words import words
from gearmath.export.markdown import bullets, paragraph, table
from gearmath.specs.hobbing import HobbingMachine

Row = tuple[str, str]

_JOB_OF_A_GEAR: tuple[Row, ...] = (
    ("Teeth", "teeth of the gear; turning fast counts by 5 and by 25"),
    ("Steps", "first number of the exact ratio in lowest terms: so many motor steps ..."),
    ("Edges", "... for so many counts of the hob encoder"),
    ("Hob", "diametral pitch (DP) or module (m) of the hob, and its number in the list of the machine file"),
    ("Blank", "outside diameter of the blank, in inch for a DP hob, in mm for a module hob"),
    ("Depth", "whole depth of the cut by the rule that stands in the last line"),
    ("Hob starts", "starts and hand of the hob"),
    ("Right hand, Left hand", "helix angle of the gear on its pitch cylinder"),
    ("Lead", "length in which the helix turns once; irrational, kept to 1/100 step over 500 mm of feed"),
)
_FED: tuple[Row, ...] = (("Feed", "of a helical gear: axial feed per turn of the table, to be kept constant"),)
_JOB_OF_A_THREAD: tuple[Row, ...] = (
    ("Pitch", "pitch of the thread in mm, or threads per inch (tpi); exact, an inch being 127/5 mm"),
    ("Feed/turn", "feed of the carriage per turn of the spindle"),
    ("Thread starts", "starts of the thread; its lead is the pitch times the starts"),
    ("Steps", "first number of the exact ratio in lowest terms: so many motor steps ..."),
    ("Edges", "... for so many counts of the spindle encoder"),
)
_RUN_OF_A_GEAR: tuple[Row, ...] = (
    (
        "Hob max",
        "the highest speed of the hob in this job: its limit, or that of the motor's steps where it is lower",
    ),
    ("Hob", "its speed now, in turns per minute"),
    ("Table", "its speed now (first page), its angle since the start of the job (second page)"),
    ("In phase: lag", "hob and table are in mesh; motor steps that wait, 0 or 1 is usual"),
    ("Lag", "motor steps that the table is behind the hob: it waits for its phase, or is catching up"),
    ("Hob turns", "since the start of the job (second page)"),
    ("Tooth", "the tooth under the hob, counted from the start (second page)"),
)
_RUN_OF_A_THREAD: tuple[Row, ...] = (
    ("Right, Left, Feed", "first line: hand and pitch of the thread, or the feed"),
    (
        "Max speed",
        "the highest speed of the spindle in this job: its limit, or that of the motor's steps where it is lower",
    ),
    ("Spindle", "its speed now, in turns per minute"),
    ("Thread start", "number of the start that is cut"),
    ("In phase: lag", "spindle and carriage are in mesh; motor steps that wait, 0 or 1 is usual"),
    ("Lag", "motor steps that the carriage is behind: it waits for its phase, or is catching up. Do not cut then"),
    ("Turns", "of the spindle since the start of the job (second page)"),
    ("Place", "travel of the carriage since the start of the job (second page)"),
    ("Shoulder in", "time until the carriage stops at the shoulder, at the present speed (second page)"),
)
_CHECKS: tuple[Row, ...] = (("Steps", "motor steps since the start of the job (third page)"),)
_OTHERS: tuple[Row, ...] = (
    ("Jog by", "what one detent moves, once a press has armed the knob"),
    ("Moved", "sum of the detents since then"),
    ("Counted, Wanted", "encoder counts of the test, and what one turn must give"),
    ("Turn", "motor steps of the one-turn test"),
)
_READOUT: tuple[Row, ...] = (
    ("Divide by", "divisions of a full turn; where the spindle stands becomes 0"),
    ("Angle", "of the spindle, turned by hand"),
    ("Beside it", "how far the spindle is beside the nearest division"),
)
_DIVIDE: tuple[Row, ...] = (
    ("Divide by", "divisions of a full turn; where the table stands becomes 0"),
    ("Go to", "division that a press moves to; each is rounded by itself, so that nothing adds up"),
    ("Angle", "angle of that division"),
)


def screens(machine: HobbingMachine) -> Iterator[str]:
    """The chapter about the display."""
    yield "## Using it"
    yield ""
    pages = "three" if machine.profile == "lathe" else "four"
    yield from paragraph(
        "Turn the knob to choose or to change, press to go on, hold for a second to go back or to the menu. While it "
        f"runs, turning shows {pages} pages and a press asks `Stop?`; nothing there changes the ratio. The motor moves "
        "only after `Start?` yes, `run on`, an armed jog, a press on `go`, or the one-turn test. A press stops a move."
    )
    yield from paragraph(
        "After power-up the last job is offered again, but not its phase: that is lost, and a start must be confirmed. "
        "After `Stop?` the motor brakes, the phase is kept, and `run on` waits until both are in mesh again. A motor "
        "that is engaged while the other side turns speeds up and overtakes what it has missed; only then the display "
        "says that it is in phase."
    )
    yield from bullets(_helps(machine))
    yield "### What every number means"
    yield ""
    yield from table(("label", "meaning"), _quoted(_rows(machine)))
    yield "### What it says"
    yield ""
    yield from table(("words", "meaning"), list(words(machine)))


def _helps(machine: HobbingMachine) -> Iterator[str]:
    """What else the pages do for the worker."""
    lathe = machine.profile == "lathe"
    picked_up = (
        "So a thread is picked up after the power was off: with the spindle standing jog the tool into the groove, "
        "enter the same job, and set the phase there. Draw the tool out, jog clear, and `run on`."
        if lathe
        else "So a gear is picked up after the power was off: with the hob standing jog the table until a tooth of the "
        "hob fits into a gap of the gear as it is fed in by hand, enter the same job, and set the phase there. Feed "
        "clear, and `run on`."
    )
    yield f"`Only set the phase`, the third answer to `Start?`, lets nothing move. {picked_up}"
    if lathe:
        yield (
            "`shoulder is here`, with the carriage jogged there after `Stop?`: each pass brakes so that it ends "
            "just before "
            "this place, on the side of the start. The same entry at the same place takes it away, a new job too. "
            "`SHOULDER: tool out` says that it has stopped; draw the tool out, then `back to start`, then `run on`."
        )
        yield "`divide` shows where the spindle stands between divisions of a turn, for indexing by hand."
    if machine.drive.backlash_steps:
        returns = ", `back to start`" if machine.profile == "lathe" else ""
        yield (
            f"Play of {machine.drive.backlash_steps} steps is taken up: `divide`{returns} comes to its place "
            "forwards, and `run "
            "on` goes back and forth first where the last motion was backwards."
        )
    yield (
        "Turn the knob while the button is held: the display begins anew, where it shows garbage. It does so by itself "
        "after it was away. Nothing else changes."
    )


def _rows(machine: HobbingMachine) -> Iterator[Row]:
    lathe = machine.profile == "lathe"
    yield from _JOB_OF_A_THREAD if lathe else _JOB_OF_A_GEAR
    if not lathe and machine.feed is None:
        yield from _FED
    yield from _RUN_OF_A_THREAD if lathe else _RUN_OF_A_GEAR
    if machine.pins.index is not None:
        turns = "turns" if machine.encoder.belt == 1 else "turns of the encoder"
        yield ("Checked", f"{turns} in which the index pulse has confirmed the count (third page)")
    yield from _CHECKS
    if not lathe and machine.feed is None:
        yield ("Table turns", "since the start of the job; times the feed per turn: the way of the pass (third page)")
    if not lathe:
        yield ("This pass", "turns of the table since the start, or the last `run on` (fourth page)")
        yield ("Last pass", "the same of the pass before, up to `Stop?`; forgotten with another ratio (fourth page)")
        yield ("Pass left", "time until this pass is as long as the last one, at the present speed (fourth page)")
    if machine.feed is not None:
        yield ("Feed", "axial feed since the start of the job (third page)")
    yield from _OTHERS
    yield from _READOUT if lathe else _DIVIDE


@dataclass(frozen=True)
class FaultRow:
    """What a fault does: to the motor while it stands with a job, follows or moves by itself ("" where it cannot come),
    and whether job and phase are kept. The tests run the firmware through every entry."""

    page: str
    fault: int
    """gm_fault of gm_core.h."""
    standing: str
    following: str
    moving: str
    kept: bool


FOLLOWS, BRAKES, STOPS, STANDS = "follows until it stands", "brakes", "gets no further pulse", "stands"
FAULT_MATRIX = (
    FaultRow("EMERGENCY STOP", 1, STANDS, FOLLOWS, BRAKES, kept=True),
    FaultRow("FAULT hob too fast", 3, STANDS, FOLLOWS, "", kept=True),
    FaultRow("FAULT table lags", 2, "", BRAKES, "", kept=False),
    FaultRow("FAULT hob encoder", 4, STANDS, BRAKES, "", kept=False),
    FaultRow("FAULT hob turned", 5, "", "", BRAKES, kept=False),
    FaultRow("FAULT motor driver", 6, STANDS, STOPS, STOPS, kept=False),
)


def _matrix(machine: HobbingMachine) -> Iterator[str]:
    """Every fault in every mode, and the loss of power."""
    pins = machine.pins
    wired = {
        1: pins.estop is not None,
        4: pins.index is not None,
        5: machine.profile != "lathe",
        6: pins.alarm is not None,
    }
    rows = [
        (f"`{row.page}`", row.standing or "-", row.following or "-", row.moving or "-", "kept" if row.kept else "lost")
        for row in FAULT_MATRIX
        if wired.get(row.fault, True)
    ]
    rows.append(("power lost", STANDS, "runs out without torque", "runs out without torque", "job kept, phase lost"))
    yield from table(("fault", "motor that stands", "that follows", "in a jog or move", "job and phase"), rows)
    yield from paragraph(
        "A supply that dips is a loss of power: the board resets, at once or when it is too low to work, and "
        "everything is "
        "off until your press. So is a program that has come to a halt: the watchdog resets the processor within "
        "a second."
    )
    outputs = ("the fail-safe output goes off at once and stays off",) * (pins.healthy is not None)
    outputs += ("ENABLE stays on",) * (pins.enable is not None)
    yield from paragraph(
        f"In every one of them {', '.join((*outputs, 'a step that has begun ends at its full length'))}."
    )


def faults(machine: HobbingMachine) -> Iterator[str]:
    """The chapter about faults."""
    leading = "spindle" if machine.profile == "lathe" else "hob"
    yield "## Faults"
    yield ""
    wired = machine.pins.healthy is not None
    sound = "emergency stop, too fast" if machine.pins.estop is not None else "too fast"
    yield from paragraph(
        f"A fault {f'stops the {leading} by the fail-safe output, and ' if wired else ''}stays on the display until "
        f"its cause is gone and the button is held. Where the drive is sound ({sound}) the motor follows until the "
        f"{leading} stands, so that the work is not spoiled, and the phase is kept, **if the {leading} takes as "
        "long to stop as the motor needs to brake**: the run-up that `gearmath gearbox plan` gives is that time, for "
        f"starting and for stopping. A {leading} that stops faster leaves the motor "
        "behind: `FAULT table lags` comes, and job and phase "
        "are lost; brake it less, or choose a lower speed. After every other fault the motor "
        f"brakes at once and the phase is lost.{' Only you let the fail-safe output go on again.' * wired}"
    )
    if not wired:
        yield from paragraph(f"**This machine has no fail-safe output: stop the {leading} yourself, at once.**")
    yield from table(("page", "meaning"), _quoted(_faults(machine, leading)))
    yield from _matrix(machine)


def _faults(machine: HobbingMachine, leading: str) -> Iterator[Row]:
    limits = machine.limits
    if machine.pins.estop is not None:
        yield ("EMERGENCY STOP", "its contact is open, or its wire is broken")
    if machine.pins.alarm is not None:
        yield ("FAULT motor driver", "the driver of the motor reports a fault of its own; the motor has no torque then")
    yield (
        "FAULT table lags",
        f"more than {limits.lag_steps} steps waited: the motor cannot keep up with the {leading}",
    )
    yield ("FAULT hob too fast", f"more than {machine.max_edge_rate} encoder counts per second: {limits.hob_rpm:g} rpm")
    if machine.profile != "lathe":
        yield ("FAULT hob turned", "the hob turned during a jog or an index move")
    if machine.pins.index is not None:
        yield (
            "FAULT hob encoder",
            "a turn was `off by` so many counts, too many (+) or too few (-): cable, noise, coupling, output pulse",
        )


def _quoted(rows: Iterator[Row]) -> Iterator[Row]:
    return ((", ".join(f"`{word}`" for word in label.split(", ")), text) for label, text in rows)
