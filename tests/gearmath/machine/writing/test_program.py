"""The written program: the rules of the control, exact positions, and refusals. Patterns are typed here afresh."""

import re
from dataclasses import replace

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.machine.control.executor import execute, run_program
from gearmath.machine.control.state import Setup
from gearmath.machine.planning.clear_space import Room
from gearmath.machine.planning.feeds import block_seconds
from gearmath.machine.writing.program import Pass, write_program
from gearmath.specs.control import ControlSettings
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
TOOLS = ("PINION_CONCAVE", "PINION_CONVEX")
ROOM = Room(top=100.0, front=120.0, half=110.0)
TOOTH = np.array([20.0, 10.0, 70.0])


def a_pass(tool=TOOLS[0], tooth=0, points=25, seed=0):
    """A roll of a plausible size, with noise far above the printed resolution; A beyond several turns."""
    noise = np.random.default_rng(seed).uniform(-1, 1, (points, 5)) * [0.1, 0.1, 0.1, 1e-3, 1e-3]
    s = np.linspace(0.0, 1.0, points)[:, None]
    # on its way A crosses 0, and X, Z pass through 0 as well
    start, end = np.array([-60.0, -80.0, -5.0, -0.6, -0.01]), np.array([70.0, 90.0, 6.0, 0.9, 0.3])
    axes = start + (end - start) * s + noise + [0, 0, 0, 2 * np.pi * tooth / 12 * 29, 0]
    return Pass(tool, "pinion roll", tooth, axes, block_seconds(axes, MACHINE, 250.0, TOOTH))


def the_passes():
    return [a_pass(tool, tooth, seed=tooth) for tool in TOOLS for tooth in range(12)]


def written(passes=None, **changes):
    arguments = {
        "name": "PINION_12X36",
        "header": ["made from a test", "settings 0123456789abcdef"],
        "passes": the_passes() if passes is None else passes,
        "machine": MACHINE,
        "spindle_rpm": 80.0,
        "clearance": 20.0,
        "room": ROOM,
        "tool_radius": 90.0,
    } | changes
    return write_program(**arguments)


def changed(position=None, value=0.0, **fields):
    """One pass with one position (row, column) or other fields replaced."""
    one = a_pass()
    if position is not None:
        axes = one.axes.copy()
        axes[position] = value
        one = replace(one, axes=axes)
    return [replace(one, **fields)]


def cutting_rows(path):
    """Rows of the path that end a G93 block: neither rapid nor the plunge that follows a rapid."""
    return ~path.rapid & ~np.roll(path.rapid, 1)


def test_reader_finds_the_positions_and_times_to_the_printed_resolution():
    passes = the_passes()
    path = execute(written(passes), "P.MPF")
    cut = cutting_rows(path)
    nominal = np.vstack([one.axes[1:] for one in passes])
    error = np.abs(path.axes[cut] - nominal)
    error[:, 3] = np.abs((path.axes[cut, 3] - nominal[:, 3] + np.pi) % (2 * np.pi) - np.pi)
    resolution = np.array([5e-6, 5e-6, 5e-6, np.radians(5e-7), np.radians(5e-7)])
    assert (error <= resolution * (1 + 1e-6)).all()
    np.testing.assert_allclose(path.seconds[cut], np.concatenate([one.seconds for one in passes]), rtol=1e-8)
    assert path.tools == TOOLS
    assert (path.tool[cut] == np.repeat([0, 1], 12 * 24)).all()
    assert path.spindle_on[path.axes[:, 2] < MACHINE.home].all()
    assert not path.spindle_on[-1]


def test_the_plunge_starts_straight_above_the_first_point_and_the_retract_goes_straight_up():
    passes = the_passes()
    path = execute(written(passes), "P.MPF")
    top = max(one.axes[:, 2].max() for one in passes) + 20.0
    plunges = np.flatnonzero(~path.rapid & np.roll(path.rapid, 1))
    assert len(plunges) == 24
    for row in plunges:
        assert (path.axes[row - 1, [0, 1, 3, 4]] == path.axes[row, [0, 1, 3, 4]]).all()
        assert path.axes[row - 1, 2] == pytest.approx(top, abs=5e-6)
    retracts = np.flatnonzero(path.rapid & ~np.roll(path.rapid, 1))
    for row in retracts:
        assert (path.axes[row - 1, [0, 1, 3, 4]] == path.axes[row, [0, 1, 3, 4]]).all()
        assert path.axes[row, 2] == pytest.approx(top, abs=5e-6)


def test_axis_a_never_takes_the_long_way():
    path = execute(written(), "P.MPF")
    cut = cutting_rows(path)
    assert np.abs(np.diff(path.axes[:, 3]))[cut[1:]].max() < 0.1  # rad; a roll of 1.5 rad in 24 blocks, with noise


def test_writing_twice_gives_the_same_text():
    assert written() == written()


def test_lint():
    number = r"-?\d+\.\d+"
    words = {
        "N": r"N\d+",
        "code": r"(?:G(?:0|1|4|17|40|54|642|90|710|93|94)|M(?:0|3|5|6|8|9|30)|SOFT|FFWON)",
        "safety": r"SUPA|TRAFOOF|COMPOF|DIAMOF|TRANS|D0|STOPRE|SECTION_\d+:|FGROUP\(X,Y,Z\)|R9[01]=0",
        "percent": r"(?:OVR|OVRRAP|ACC\[[XYZAB]\])=100|(?:CTOL|OTOL)=0\.\d+",
        "mm": r"[XYZ]-?\d+\.\d{5}",
        "A": r"A=DC\(\d+\.\d{6}\)",
        "B": r"B-?\d+\.\d{6}",
        "feed": r"[FS]\d+\.\d+",
        "tool": r'T="[A-Z_0-9]+"|D1',
    }
    word = re.compile("|".join(words.values()))
    text = written()
    assert text.isascii()
    assert text.endswith("M30\n")
    assert "\r" not in text
    assert "\t" not in text
    numbers = []
    for line in text.split("\n")[:-1]:
        assert len(line) < 250
        if line.startswith(";"):
            continue
        if re.match(r"N\d+ (?:IF |ENDIF$|MSG\(\"[ -~]*\"\)$|SETAL\(650\d\d\)$)", line):
            numbers.append(int(line.split(" ")[0].removeprefix("N")))
            continue
        tokens = line.split(" ")
        assert all(word.fullmatch(token) for token in tokens), line
        assert not re.search(r"-0\.0+\b", line), line
        numbers.append(int(tokens[0].removeprefix("N")))
        if "G93" in tokens:
            assert [token[0] for token in tokens[3:]] == list("XYZABF"), line
            assert float(re.search(rf"F({number})", line)[1]) > 0
        for angle in re.findall(rf"A=DC\(({number})\)", line):
            assert 0 <= float(angle) < 360
    assert numbers == list(range(10, 10 * len(numbers) + 1, 10))


def test_small_negative_and_nearly_whole_turns_are_printed_as_zero():
    axes = np.array([[1.0, 0, 0, -1e-9, 0], [-1e-7, -4e-6, 1.0, -1e-9, -1e-10], [0, 0, 2.0, 2 * np.pi - 1e-10, 0]])
    axes[2, 3] -= 2 * np.pi
    text = written([Pass("T1", "zero", 0, axes, np.array([1.0, 1.0]))])
    assert "G93 G1 X0.00000 Y0.00000 Z1.00000 A=DC(0.000000) B0.000000 F60.0" in text
    assert "-0.0" not in text
    assert "360." not in text


def test_header_and_program_start():
    lines = written().split("\n")
    assert lines[:3] == ["; PINION_12X36", "; made from a test", "; settings 0123456789abcdef"]
    assert lines[3] == "N10 G17 G40 G90 G94 G710 G54 G642 CTOL=0.000050 OTOL=0.0000278 SOFT FFWON"
    blocks = [line.partition(" ")[2] for line in lines[4:]]
    assert blocks[:3] == ["TRAFOOF", "COMPOF", "DIAMOF"]
    moves = [block for block in blocks if re.match(r"(?:G94 )?G[01] ", block)]
    assert moves[:3] == ["G0 SUPA Z900.00000"] * 3  # up before the tool change, before, and after it
    assert moves[3].startswith("G0 X")
    assert moves[4].startswith("G0 Z")
    fetched = blocks.index('T="PINION_CONCAVE" D1')
    assert blocks[fetched + 1] == "M6"
    spindle = blocks.index("S80.000 M3")
    assert blocks[spindle + 1 : spindle + 3] == ["G4 F3.0", "M8"]


def test_a_counting_axis_is_written_as_it_counts():
    axis = MACHINE.axes.A.model_copy(update={"modulo": False, "travel": (-360.0, 7200.0)})
    counting = MACHINE.model_copy(update={"axes": MACHINE.axes.model_copy(update={"A": axis})})
    passes = [a_pass(tooth=tooth) for tooth in (0, 5)]  # of 12: more than twelve turns on
    text = written(passes, machine=counting)
    assert "DC(" not in text
    assert execute(text, "P.MPF").axes[cutting_rows(execute(text, "P.MPF")), 3] == pytest.approx(
        np.concatenate([one.axes[1:, 3] for one in passes]), abs=np.radians(5.1e-7)
    )


def test_direction_of_the_cutter_and_options_of_the_control_come_from_the_machine_file():
    control = ControlSettings(path_mode="G60", jerk="BRISK", feed_forward=True)
    text = written(machine=MACHINE.model_copy(update={"cutter_direction": "M4", "control": control}))
    head = text.split("\n")[3]
    assert head == "N10 G17 G40 G90 G94 G710 G54 G60 BRISK FFWON"
    assert text.count(head.partition(" ")[2]) == 1 + 24  # and once more in every section
    assert " M3\n" not in text
    assert text.count("S80.000 M4\n") == 2
    assert "FFWON" not in written(machine=MACHINE.model_copy(update={"control": ControlSettings(feed_forward=False)}))
    path = execute(text, "P.MPF")
    assert path.spindle_on[path.axes[:, 2] < MACHINE.home].all()


def test_increments_of_the_control_decide_the_decimals():
    coarse = MACHINE.model_copy(update={"control": ControlSettings()})
    path = execute(written(machine=coarse), "P.MPF")
    np.testing.assert_allclose(path.axes[:, :3], np.round(path.axes[:, :3], 3), rtol=0, atol=1e-12)
    degrees = np.degrees(path.axes[:, 3:])
    np.testing.assert_allclose(degrees, np.round(degrees, 3), rtol=0, atol=1e-9)


def test_with_the_tool_length_in_the_table_z_is_that_of_the_tip():
    """The control adds the length of 150 mm to the programmed Z: the machine moves as it does without."""
    tip = MACHINE.model_copy(update={"z_reference": "tip"})
    text = written(machine=tip)
    assert execute(text, "P.MPF", Setup.of(tip)).axes == pytest.approx(execute(written(), "P.MPF").axes, abs=1e-9)
    with pytest.raises(InputError, match="alarm 65014: length 1 of PINION_CONCAVE in the tool table must be 150"):
        execute(text, "P.MPF")
    with pytest.raises(InputError, match="alarm 65014: length 1 of PINION_CONCAVE in the tool table must be 0"):
        execute(written(), "P.MPF", Setup.of(tip))


def test_a_work_offset_moves_the_whole_program():
    """Machine coordinates are those of the file and the offset; SUPA, which takes off all offsets, goes there too."""
    values = (-250.0, 12.5, -700.0, 5.0, 0.25)
    shifted = MACHINE.model_copy(update={"work_offset_values": values})
    text = written(machine=shifted)
    assert "G0 SUPA Z200.00000" in text
    assert execute(text, "P.MPF", Setup.of(shifted)).axes == pytest.approx(execute(written(), "P.MPF").axes, abs=1e-9)
    with pytest.raises(InputError, match=r"alarm 65012: G54 with all frames must be X-250 Y12\.5 Z-700 A5 B0\.25"):
        execute(text, "P.MPF")


def test_home_of_z_must_clear_the_work_at_every_b():
    with pytest.raises(
        InputError, match=r"home of Z = 900 mm: the tool clears the work at every B from Z 901\.0 mm on"
    ):
        written(room=replace(ROOM, top=401.0))


@pytest.mark.parametrize(("first", "last", "sections"), [(0, 0, 24), (3, 5, 3), (20, 0, 5), (0, 13, 13), (24, 24, 1)])
def test_sections_can_be_cut_by_themselves(first, last, sections):
    """After an abort the program goes on at any section, with its own tool, and asks before it does."""
    whole, run = execute(written(), "P.MPF"), run_program(written(), "P.MPF", parameters={90: first, 91: last})
    cut = cutting_rows(run.path)
    assert cut.sum() == 24 * sections
    begin = 24 * max(first - 1, 0)
    expected = whole.axes[cutting_rows(whole)][begin : begin + 24 * sections]
    expected[:, 3] += 2 * np.pi * np.round((run.path.axes[cut][0, 3] - expected[0, 3]) / (2 * np.pi))
    assert run.path.axes[cut] == pytest.approx(expected, abs=1e-9)
    assert run.messages[-1].startswith(f"section {last or 24} of 24: ")
    assert (run.messages[0].startswith("only sections")) == ((first, last) != (0, 0))
    assert (run.parameters[90], run.parameters[91]) == (0, 0)


@pytest.mark.parametrize(("first", "last"), [(-1, 0), (25, 0), (0, 25), (5, 3)])
def test_sections_that_there_are_not_stop_the_program_before_it_moves(first, last):
    run = run_program(written(), "P.MPF", parameters={90: first, 91: last})
    assert run.alarm is not None
    assert run.alarm[0] == 65016
    assert len(run.path.axes) == 0


def test_a_dwell_stands_between_the_cut_and_the_retract():
    lines = written(changed(dwell=0.75)).split("\n")
    _, row = (k for k, line in enumerate(lines) if " G4 " in line)  # the first waits for the spindle
    assert lines[row].endswith("G4 F0.750000000")
    assert "G93 G1" in lines[row - 1]
    assert "G94 G0 Z" in lines[row + 1]


def test_without_coolant_there_is_no_m8():
    assert "M8" in written()
    assert "M8" not in written(coolant=False)


@pytest.mark.parametrize("name", ["AB", "_A", "a" * 24, "CONE", "COM10", "AB_1"])
def test_program_names_that_the_control_takes(name):
    assert written(changed(), name=name).startswith(f"; {name}\n")


@pytest.mark.parametrize("name", ["", "A", "1AB", "_1", "A1", "a" * 25, "AB-C", "AB.MPF", "con", "Com1", "ÄB", "AB\n"])
def test_program_names_that_the_control_does_not_take(name):
    with pytest.raises(InputError, match="program name"):
        written(changed(), name=name)


@pytest.mark.parametrize("text", ["two\nlines", "bell\a", "5 µm", "tab\t", "x" * 248, "cr\r"])
def test_comments_that_would_break_a_block(text):
    with pytest.raises(InputError, match="comment"):
        written(changed(), header=[text])
    with pytest.raises(InputError, match="comment"):
        written(changed(label=text))


def test_the_longest_comment_stays_within_a_block():
    text = written(changed(), header=["x" * 247])
    assert max(len(line) + 1 for line in text.split("\n")) == 250


@pytest.mark.parametrize(
    ("passes", "sentence"),
    [
        (changed((3, 0), 412.5), r"axis X = 412\.50000 mm at point 3: .* travels -400 to 400 mm"),
        (changed((4, 4), np.radians(-11)), r"axis B = -11\.00000 degrees at point 4: .* -10 to 100 degrees"),
        (changed((slice(None), 2), 890.0), r"axis Z = 910\.00000 mm above the first point: .* -100 to 900 mm"),
        (changed((2, 1), np.nan), r"axis Y = nan at point 2: must be finite"),
        (changed((2, 3), np.inf), r"axis A = inf at point 2: must be finite"),
        (changed(seconds=np.full(24, 1e-3)), r"axis X = .* mm/min in block 0: .* allows 20000 mm/min"),
        (changed((slice(5, None), 3), 9.0), r"axis A = .* degrees/min in block 4: .* allows 7200 degrees/min"),
        (changed((slice(5, None), 3), 9.0, seconds=np.full(24, 20.0)), r"axis A turns .* in block 4: .* less than 180"),
        (changed(seconds=np.zeros(24)), r"time = 0\.0 s of block 0: must be 0\.0001 to 100000 s"),
        (changed(seconds=np.full(24, np.nan)), r"time = nan s of block 0"),
        (changed(seconds=np.full(24, 0.05)), r"axis X = .* mm/s2 in block 0: .* allows 3000 mm/s2"),
        (changed(dwell=-1.0), r"dwell = -1\.0 s: must be 0 to 100000 s"),
        (changed(seconds=np.ones(25)), r"has positions \(25, 5\) and times \(25,\)"),
        (changed(tool='A"B'), r"tool = 'A\"B': must be 1 to 31 letters"),
    ],
)
def test_what_the_machine_cannot_do_is_refused_with_pass_axis_value_and_limit(passes, sentence):
    with pytest.raises(InputError, match=r"^PINION_12X36, pass 'pinion roll', tooth 0: " + sentence):
        written(passes)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"spindle_rpm": 3001.0}, r"spindle speed = 3001\.0 rpm: .* has 20 to 3000 rpm"),
        ({"spindle_rpm": float("nan")}, r"spindle speed = nan rpm"),
        ({"clearance": 0.0}, r"clearance = 0\.0 mm: must be greater than 0"),
        ({"clearance": float("inf")}, r"clearance = inf mm"),
        ({"plunge_feed_mm_min": 0.0}, r"plunge feed = 0\.0 mm/min: must be 0\.001 to 15000 mm/min"),
        ({"passes": []}, r"there is no pass"),
    ],
)
def test_faulty_process_values_are_refused(arguments, sentence):
    with pytest.raises(InputError, match=r"^PINION_12X36: " + sentence):
        written(**arguments)
