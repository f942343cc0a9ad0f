"""What the firmware says on its display beside numbers and faults, and what that means: a table of the README.

The words are those of ``firmware/gm_screen.c`` and ``gm_gear.c``; a test compares them.
"""

from __future__ import annotations

from collections.abc import Iterator

from gearmath.specs.hobbing import HobbingMachine

#: Texts, parted by bars where several mean the same, and what they mean.
_Words = tuple[str, str]

_BOTH: tuple[_Words, ...] = (
    ("PHASE IS LOST", "after power-up: the job is there, but not where the motor stands in it"),
    ("Last job restored | No stored job", "after power-up: whether the EEPROM has a job of this machine"),
    ("REFUSED", "this job cannot be done; the line below it says why, the next rows what to do"),
    ("too many steps/s", "at the highest speed the motor would need more than `step_rate_hz`"),
    ("Set limit", "the speed at which it could: write it as `hob_rpm`, export again, do not run faster"),
    ("ratio over 64/edge", "one encoder count would be more than 64 steps: more encoder lines, fewer microsteps"),
    ("ratio needs 64 bit", "the exact ratio has too many digits: another number of teeth, a pitch of fewer decimals"),
    ("OLD PHASE WILL GO", "a start gives up the phase that is kept; `run on` after `Stop?` keeps it"),
    ("PHASE STARTS HERE", "as both stand now they are in mesh from then on"),
    ("WAITS FOR THE PHASE", "after `run on`: the motor stands until the other side comes by its place"),
    ("CATCHING UP", "the motor overtakes what it has missed: do not cut yet"),
    ("RUNS", "speed while it asks `Stop?`"),
    ("STOPPING", "the motor brakes"),
    ("STOPPED, phase kept", "what to do next: `wait`, `run on, same phase`, `jog`, `new job`"),
    ("ARMED: knob moves", "each detent moves the motor; a press disarms it"),
    ("OK within 1 % | OK, but backwards", "the encoder test: right, or A and B are exchanged"),
    ("1000 lines, not 1024 | 1024 lines, not 1000", "the encoder has other lines than the machine file says"),
    (
        "1/4: decoder mode? | 1/2: decoder mode? | x2: decoder mode? | x4: decoder mode?",
        "it counts so much of what is wanted: jumper or lines",
    ),
    ("WRONG: wiring, lines", "the encoder test: none of these"),
    ("Phase is set here", "`Only set the phase` is done: as both stand now they are in mesh"),
    (
        "Refused by the core",
        "the motor part of the program does not take this job or move: an alarm, a fault, a motion",
    ),
    ("Not now: table moves", "wait until the motor stands"),
    ("Too far: jog | Too far: new job", "a move beyond what is counted: jog nearer, or begin a new job"),
    ("PHASE LOST: set up", "a fault has ended the job: set the work up anew"),
    ("Phase kept. Hold: on", "a fault that keeps the job: hold the button to go on"),
    ("Follows till it ends", "after a stop: the motor follows until the other side stands"),
    ("No index pulse", "no index is wired: lost edges are not noticed"),
    ("FAULT | Unknown", "cannot come: tell us"),
    ("The cause is there", "a fault cannot be acknowledged while its cause is there"),
    ("Move stopped", "a press has stopped the move"),
    ("Mark off? Check belt", "the one-turn test: whether the mark has come back, by eye"),
)
_OF_HOBBING: tuple[_Words, ...] = (
    ("teeth: 1 to 999", "why a job is refused: its number of teeth"),
    ("helix: 0 to 60 deg", "why a job is refused: its helix angle"),
    ("feed not possible", "why a job is refused: a helix needs a feed that the ratio can hold"),
    ("hob is not known", "a stored job is of a hob that the machine file no longer has"),
    ("Not now: hob turns?", "a move is refused while the hob turns"),
    ("HOB TURNS: KEEP FREE", "the hob turns already: nothing may touch the blank until it is in phase"),
    ("No pass before", "there is no pass to compare with yet (fourth page)"),
)
_OF_A_LATHE: tuple[_Words, ...] = (
    ("pitch not possible", "why a job is refused: its pitch"),
    ("Stop spindle first", "the next start of the thread is taken with the spindle at rest"),
    ("Next start is ready", "the carriage is placed for the next start of the thread"),
    ("Spindle moved: lost", "the spindle turned while the carriage moved by itself: set the phase anew"),
)
_OF_ANY: tuple[_Words, ...] = (
    ("starts: 1 to 10", "why a job is refused: starts of hob or thread"),
    ("other kind of job", "a stored job is of the other kind of machine"),
)


def words(machine: HobbingMachine) -> Iterator[tuple[str, str]]:
    """Rows of words and meaning, for one kind of machine."""
    lathe = machine.profile == "lathe"
    for said, meaning in (*_BOTH, *(_OF_A_LATHE if lathe else _OF_HOBBING), *_OF_ANY):
        started = meaning.replace("hob or thread", "the thread" if lathe else "the hob")
        yield ", ".join(f"`{each}`" for each in said.split(" | ")), started
