"""The exported sketch folder: it compiles and links for every board, calls only what exists, and runs.

The Arduino API is the stand-in of ``tests/arduino_stand_in``, whose signatures are those of the Teensy cores.
"""

from __future__ import annotations

import ctypes
import itertools
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from elftools.elf.elffile import ELFFile

from gearmath.errors import InputError
from gearmath.export.teensy import export_teensy, teensy_files
from gearmath.specs.drive import Feed
from gearmath.specs.hobbing import HobbingMachine, load_hobbing_machine
from gearmath.specs.toml import bundled, parse

STAND_IN = Path(__file__).parents[2] / "arduino_stand_in"
MACHINES = ("hobbing_plewes", "hobbing_metric", "hobbing_helical", "lathe_example")
STRICT = ("-Wall", "-Wextra", "-Werror", "-O1")
#: What the Teensy 3.x cores add: no literal of the firmware may lose by it.
SINGLE = "-fsingle-precision-constant"
CXX = ("-std=c++17", "-fno-exceptions", "-fno-rtti")
#: board -> what Teensyduino defines, then the processor for GCC and for zig
BOARDS = {
    "teensy32": (("-DARDUINO_TEENSY32", "-D__MK20DX256__"), ("-mcpu=cortex-m4",), "cortex_m4"),
    "teensy40": (("-DARDUINO_TEENSY40", "-D__IMXRT1062__"), ("-mcpu=cortex-m7",), "cortex_m7"),
    "teensy41": (("-DARDUINO_TEENSY41", "-D__IMXRT1062__"), ("-mcpu=cortex-m7",), "cortex_m7"),
}
_FLOATING = re.compile(r"__aeabi_(?:c?[df]\w+|[iul]{1,2}2[df])|__[a-z]+[sd]f[0-9a-z]*")


def machine(name: str) -> HobbingMachine:
    return load_hobbing_machine(bundled(f"{name}.toml"))


def at_once(base: HobbingMachine) -> HobbingMachine:
    """With a motor that follows a hob which starts at full speed."""
    return base.model_copy(update={"limits": base.limits.model_copy(update={"acceleration_hz_per_s": 1e7})})


def with_pins(base: HobbingMachine, **pins: int | None) -> HobbingMachine:
    return base.model_copy(update={"pins": base.pins.model_copy(update=pins)})


def variants() -> Iterator[HobbingMachine]:
    """Every optional wire with and without, on every board, with both displays and both decoders."""
    boards = tuple(itertools.product(BOARDS, ("adafruit292", "pcf8574"), ("ls7184_x4", "hardware")))
    wires = tuple(itertools.product((False, True), repeat=5))
    for chosen, board in zip(wires, itertools.cycle(boards), strict=False):
        yield _variant(machine("hobbing_plewes"), board, chosen)
    for board in boards:
        yield _variant(machine("hobbing_metric"), board, (True,) * 5)


def _variant(base: HobbingMachine, board: tuple[str, str, str], wires: tuple[bool, ...]) -> HobbingMachine:
    feed, index, estop, healthy, enable = wires
    pins = dict(
        [("feed_step", 9), ("feed_dir", 10)] * feed
        + [("index", 11)] * index
        + [("estop", 12)] * estop
        + [("healthy", 14)] * healthy
        + [("enable", 15)] * enable
    )
    changed = with_pins(base, **pins)
    update = {
        "board": board[0],
        "display": base.display.model_copy(update={"kind": board[1]}),
        "encoder": base.encoder.model_copy(update={"decoder": board[2]}),
        "feed": Feed(counts_per_mm=200, counts_up="climb") if feed else None,
    }
    return changed.model_copy(update=update)


def write(files: dict[str, str], folder: Path) -> Path:
    """The folder, with a file that does what the Arduino tools do with a sketch."""
    folder.mkdir(exist_ok=True)
    for name, text in files.items():
        (folder / name).write_text(text, "utf-8")
    (sketch,) = (name for name in files if name.endswith(".ino"))
    (folder / "sketch.cpp").write_text(f'#include <Arduino.h>\n#include "{sketch}"\n')
    return folder


def run(folder: Path, *command: str) -> None:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stderr}"


def c_files(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.glob("*.c"))


def code_of(text: str) -> str:
    """C without its comments, its strings and the names of its headers."""
    return re.sub(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\])*"|<[^>\n]*>', " ", text, flags=re.DOTALL)


@pytest.fixture(scope="module")
def arm() -> str:
    if shutil.which("arm-none-eabi-gcc") is None or shutil.which("arm-none-eabi-g++") is None:
        pytest.skip("needs arm-none-eabi-gcc")
    return "arm-none-eabi-"


@pytest.mark.slow
def test_every_variant_compiles_for_its_board(tmp_path: Path, arm: str) -> None:
    for changed in variants():
        defines, processor, _ = BOARDS[changed.board]
        folder = write(teensy_files(changed), tmp_path / "gearbox")
        run(folder, f"{arm}gcc", *processor, "-mthumb", "-std=c99", *STRICT, SINGLE, "-fsyntax-only", *c_files(folder))
        flags = (*processor, "-mthumb", *CXX, *STRICT, SINGLE, *defines, f"-I{STAND_IN}")
        run(folder, f"{arm}g++", *flags, "-fsyntax-only", "sketch.cpp")


@pytest.fixture(scope="module")
def objects(arm: str, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, str], Path]:
    """The folder of a bundled machine, compiled for its board at a level of optimization, without a warning."""
    done: dict[tuple[str, str], Path] = {}

    def compiled(name: str, level: str) -> Path:
        if (name, level) not in done:
            given = machine(name)
            defines, processor, _ = BOARDS[given.board]
            folder = write(teensy_files(given), tmp_path_factory.mktemp("built") / "gearbox")
            common = (*processor, "-mthumb", "-mfloat-abi=soft", level, "-Wall", "-Wextra", "-Werror", SINGLE)
            run(folder, f"{arm}gcc", *common, "-std=c99", "-c", *c_files(folder))
            run(folder, f"{arm}g++", *common, *CXX, *defines, f"-I{STAND_IN}", "-c", "sketch.cpp")
            done[name, level] = folder
        return done[name, level]

    return compiled


@pytest.mark.parametrize("level", ["-O1", "-O2", "-O3", "-Os"])
@pytest.mark.parametrize("name", ["hobbing_default", "hobbing_helical"])
def test_no_level_of_optimization_brings_a_warning_for_the_board(
    name: str, level: str, objects: Callable[[str, str], Path]
) -> None:
    """A machine for each processor, Cortex-M4 and M7."""
    assert (objects(name, level) / "sketch.o").stat().st_size > 0


@pytest.mark.parametrize("name", MACHINES)
def test_bundled_machine_links_without_any_floating_call(
    name: str, arm: str, objects: Callable[[str, str], Path]
) -> None:
    given = machine(name)
    defines, processor, _ = BOARDS[given.board]
    folder = objects(name, "-Os")
    common = (*processor, "-mthumb", "-mfloat-abi=soft", "-Os", *CXX, *defines, f"-I{STAND_IN}")
    ours = ("stand_in", "main")
    run(folder, f"{arm}g++", *common, "-c", *(str(STAND_IN / f"{source}.cpp") for source in ours))
    linked = sorted(path.name for path in folder.glob("*.o"))
    run(folder, f"{arm}gcc", *processor, "-mthumb", "--specs=nosys.specs", *linked, "-o", "sketch.elf")
    with (folder / "sketch.elf").open("rb") as stream:
        names = {symbol.name for symbol in ELFFile(stream).get_section_by_name(".symtab").iter_symbols()}
    assert {"gm_core_tick", "gm_ui_event", "main"} <= names
    assert [symbol for symbol in names if _FLOATING.fullmatch(symbol)] == []


@pytest.mark.parametrize("name", ["hobbing_default", "hobbing_helical", "lathe_example"])
def test_flash_and_ram_of_the_readme_are_those_of_the_compiled_files(
    name: str, arm: str, objects: Callable[[str, str], Path]
) -> None:
    """One machine a board; -O2 is what the IDE calls Faster, -Os Smallest Code."""
    readme = " ".join(teensy_files(machine(name))["README.md"].split())
    said = r"take about ([\d.]+) kB of flash and ([\d.]+) kB of RAM .*?; ([\d.]+) kB of flash with -Os"
    stated = re.search(said, readme)
    assert stated is not None
    for level, flash in (("-O2", stated[1]), ("-Os", stated[3])):
        folder = objects(name, level)
        files = [*(f"{source.removesuffix('.c')}.o" for source in c_files(folder)), "sketch.o"]
        sizes = subprocess.run([f"{arm}size", *files], cwd=folder, capture_output=True, check=True, text=True).stdout
        rows = ([int(number) for number in line.split()[:3]] for line in sizes.splitlines()[1:])
        text, data, bss = (sum(column) for column in zip(*rows, strict=True))
        assert float(flash) * 1000 == pytest.approx(text + data, rel=0.05)
        assert float(stated[2]) * 1000 == pytest.approx(data + bss, rel=0.1)


@pytest.mark.parametrize("level", ["-O1", "-O3"])
def test_no_level_of_optimization_brings_a_warning_on_this_computer(level: str, tmp_path: Path) -> None:
    if shutil.which("g++") is None or shutil.which("gcc") is None:
        pytest.skip("needs g++")
    given = machine("hobbing_default")
    folder = write(teensy_files(given), tmp_path / "gearbox")
    run(folder, "gcc", level, "-Wall", "-Wextra", "-Werror", "-std=c99", "-c", *c_files(folder))
    flags = (level, "-Wall", "-Wextra", "-Werror", *CXX, *BOARDS[given.board][0], f"-I{STAND_IN}")
    run(folder, "g++", *flags, "-c", "sketch.cpp")


def test_the_search_for_floating_calls_finds_them() -> None:
    for symbol in (
        "__aeabi_dmul",
        "__aeabi_fadd",
        "__aeabi_i2d",
        "__aeabi_ul2f",
        "__aeabi_cdcmple",
        "__muldf3",
        "__floatsisf",
    ):
        assert _FLOATING.fullmatch(symbol), symbol
    for symbol in ("__aeabi_ldivmod", "__aeabi_idiv0", "__aeabi_uldivmod", "__aeabi_memset"):
        assert not _FLOATING.fullmatch(symbol), symbol


@pytest.mark.parametrize("name", MACHINES)
def test_clang_accepts_the_folder_for_its_processor(name: str, tmp_path: Path) -> None:
    given = machine(name)
    defines, _, processor = BOARDS[given.board]
    folder = write(teensy_files(given), tmp_path / "gearbox")
    zig = (sys.executable, "-m", "ziglang")
    common = (
        "-target",
        "thumb-freestanding-eabi",
        f"-mcpu={processor}",
        "-mfloat-abi=soft",
        "-ffreestanding",
        *STRICT,
        "-isystem",
        str(STAND_IN / "freestanding"),
        "-c",
    )
    for source in c_files(folder):
        run(folder, *zig, "cc", *common, "-std=c99", source, "-o", "one.o")
    run(folder, *zig, "c++", *common, *CXX, *defines, f"-I{STAND_IN}", "sketch.cpp", "-o", "sketch.o")


@pytest.mark.parametrize("name", MACHINES)
def test_firmware_holds_no_floating_constant_and_no_floating_type(name: str) -> None:
    for file, text in teensy_files(machine(name)).items():
        if not file.endswith((".c", ".h", ".ino")):
            continue
        code = code_of(text)
        assert not re.search(r"(?<![\w.])\d+\.|\.\d|(?<![\w.])\d+[eE][+-]?\d|\b(?:float|double)\b", code), file
    # and the search finds one
    assert re.search(r"(?<![\w.])\d+\.|\.\d", "x = 1.5;")


def test_interrupts_and_the_run_loop_wait_for_nothing() -> None:
    files = teensy_files(machine("hobbing_helical"))
    for file in ("gearbox.ino", "gm_core.c"):
        assert not re.search(r"\bdelay|while \(!|for \(;;\)|while \(1\)", code_of(files[file])), file


def test_wrong_board_is_refused_by_the_compiler(tmp_path: Path, arm: str) -> None:
    folder = write(teensy_files(machine("hobbing_plewes")), tmp_path / "gearbox")
    defines, processor, _ = BOARDS["teensy41"]
    command = [f"{arm}g++", *processor, "-mthumb", *CXX, *defines, "-fsyntax-only", f"-I{STAND_IN}", "sketch.cpp"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode != 0
    assert "this machine has a Teensy 3.2: choose it under Tools, Board" in done.stderr


# --- the folder ---------------------------------------------------------------------------------------------------
def test_sketch_carries_the_name_of_its_folder(tmp_path: Path) -> None:
    names = export_teensy(machine("hobbing_plewes"), tmp_path / "Hobber-2")
    assert [name for name in names if name.endswith(".ino")] == ["Hobber-2.ino"]
    assert {path.name for path in (tmp_path / "Hobber-2").iterdir()} == {*names, "manifest.json"}


@pytest.mark.parametrize("name", ["my gears", "-x", ".hidden", "Zahnräder", "a" * 64, "a;b"])
def test_folder_that_cannot_be_a_sketch_is_refused_and_not_made(name: str, tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match=r"the folder's name becomes the sketch's name, which takes 1 to 63 plain letters"
    ):
        export_teensy(machine("hobbing_plewes"), tmp_path / name)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", MACHINES)
def test_numbers_of_the_machine_stand_in_the_header(name: str) -> None:
    given = machine(name)
    text = teensy_files(given)["gm_machine.h"]
    macros = {key: int(value) for key, value in re.findall(r"^#define (GM_\w+) (-?\d+)", text, flags=re.MULTILINE)}
    assert macros["GM_ENCODER_COUNTS"] == given.encoder.lines * 4
    for key, number in given.pins.used():
        assert macros[f"GM_PIN_{key.upper()}"] == number
    assert macros["GM_HOBS"] == len(given.hobs) == text.count("  {GM_")
    if given.profile == "lathe":
        # 4800 steps a turn of a screw of 8 threads per inch
        assert Fraction(macros["GM_SCREW_STEPS_NUM"], macros["GM_SCREW_STEPS_DEN"]) == 4800 * 8 / Fraction("25.4")
    else:
        assert macros["GM_MOTOR_STEPS"] == 200 * 4 * 2 * 10
    # driver times in whole ticks, never shorter than asked for even if a tick comes late
    asked = given.driver.timing
    others = 1 + (given.feed is not None) + (given.pins.index is not None)  # interrupts that a tick may wait for
    late = others * given.hardware.jitter_ns if asked.confirmed else 0
    for ticks, time in zip(
        ("STEP_HIGH", "STEP_LOW", "DIR_SETUP", "DIR_HOLD"),
        (asked.step_high, asked.step_low, asked.dir_setup, asked.dir_hold),
        strict=True,
    ):
        given_ns = macros[f"GM_{ticks}_TICKS"] * macros["GM_TICK_NS"]
        assert time + late <= given_ns < time + late + macros["GM_TICK_NS"]


def test_open_collector_inverts_the_level_at_the_pin() -> None:
    base = machine("hobbing_plewes")
    for output, active, low in (("open_collector", "low", 0), ("open_collector", "high", 1), ("direct", "low", 1)):
        driver = base.driver.model_copy(update={"output": output, "step_active": active})
        text = teensy_files(base.model_copy(update={"driver": driver}))["gm_machine.h"]
        assert f"#define GM_STEP_ACTIVE_LOW {low} " in text


# --- the sketch at work, on this computer -------------------------------------------------------------------------
class Board:
    """One board in memory, in the hands of an operator."""

    def __init__(
        self, library: Path, eeprom: bytes = b"", display_off: bool = False, hob_every: int = 0, wait: int = 500
    ) -> None:
        self.board = ctypes.CDLL(str(library))
        self.board.board_press_and_count.restype = ctypes.c_long
        self.board.board_display_off(int(display_off))
        self.board.board_position.restype = ctypes.c_long
        self.board.board_bad_pulses.restype = ctypes.c_long
        self.board.board_turn_hob(ctypes.c_long(hob_every))  # ticks from edge to edge
        self.board.board_power_up(eeprom, ctypes.c_long(len(eeprom)))
        self.wait(wait)

    def wait(self, ms: int) -> None:
        self.board.board_pass(ctypes.c_long(ms))

    def press(self, ms: int = 100) -> None:
        self.board.board_press(ctypes.c_long(ms))

    def knob(self, detents: int) -> None:
        self.board.board_knob(detents)

    def hob(self, edges: int, forward: bool = True, ticks: int = 4) -> None:
        self.board.board_hob(ctypes.c_long(edges), int(forward), ctypes.c_long(ticks))

    def display(self) -> list[str]:
        text = ctypes.create_string_buffer(80)
        self.board.board_display(text)
        letters = text.raw.decode("ascii")
        return [letters[row * 20 : row * 20 + 20].rstrip() for row in range(4)]

    def eeprom(self) -> bytes:
        copy = ctypes.create_string_buffer(4284)
        self.board.board_eeprom(copy)
        return copy.raw

    def start(self) -> None:
        """From power-up through the pages of the job to "Start?" yes."""
        for _ in range(12):
            if self.display()[3].startswith("Start?"):
                break
            self.press()
        self.knob(1)
        assert self.display()[3] == "Start?    no  >yes<"
        self.press()


@pytest.fixture(scope="module")
def power_up(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Board]:
    """``power_up(machine, eeprom, hob_every=...)``: a board with that machine's sketch, compiled for this computer."""
    if shutil.which("g++") is None or shutil.which("gcc") is None:
        pytest.skip("needs g++")
    built: dict[str, Path] = {}

    def make(given: HobbingMachine, eeprom: bytes = b"", **situation: int) -> Board:
        key = given.model_dump_json()
        if key not in built:
            built[key] = _build(given, tmp_path_factory.mktemp("sketch"))
        fresh = tmp_path_factory.mktemp("power") / "board.so"  # another file is another memory
        shutil.copy(built[key], fresh)
        return Board(fresh, eeprom, **situation)

    return make


def _build(given: HobbingMachine, place: Path) -> Path:
    folder = write(teensy_files(given), place / "gearbox")
    defines = BOARDS[given.board][0]
    common = ("-O1", "-fPIC", "-Wall", "-Wextra", "-Werror")
    run(folder, "gcc", *common, "-std=c99", "-c", *c_files(folder))
    sources = ("sketch.cpp", str(STAND_IN / "stand_in.cpp"), str(STAND_IN / "board.cpp"))
    run(folder, "g++", *common, *CXX, *defines, f"-I{STAND_IN}", "-I.", "-c", *sources)
    run(folder, "gcc", "-shared", *sorted(path.name for path in folder.glob("*.o")), "-o", "board.so")
    return folder / "board.so"


def test_motor_follows_the_hob_through_the_pins(power_up: Callable[..., Board]) -> None:
    board = power_up(at_once(machine("hobbing_plewes")))
    board.start()
    assert board.display()[3].startswith("In phase: lag")
    steps_per_edge = Fraction(16000, 24 * 4096)  # the job of a first power-up: 24 teeth
    turned = 0
    for edges, forward in ((40960, True), (5000, False), (1, False), (12345, True)):
        board.hob(edges, forward)
        board.wait(20)
        turned += edges if forward else -edges
        assert abs(board.board.board_position() - turned * steps_per_edge) <= Fraction(1, 2)
    assert board.board.board_bad_pulses() == 0


def test_channels_of_the_boards_own_decoder_follow_too(power_up: Callable[..., Board]) -> None:
    base = at_once(machine("hobbing_plewes"))
    board = power_up(base.model_copy(update={"encoder": base.encoder.model_copy(update={"decoder": "hardware"})}))
    board.start()
    board.hob(12000, ticks=5)
    board.hob(500, forward=False, ticks=5)
    board.wait(20)
    assert board.board.board_position() == round(11500 * Fraction(16000, 24 * 4096))


COUNTERS = {
    "FTM1, channels": ("teensy32", {"decoder": '"hardware"'}, ""),
    "FTM1 on its other pins": (
        "teensy32",
        {"decoder": '"hardware"'},
        "encoder_step = 3\nencoder_dir = 4\nknob_b = 5\nbutton = 9",
    ),
    "FTM2, channels": ("teensy32", {"decoder": '"hardware"'}, "encoder_step = 32\nencoder_dir = 25"),
    "FTM1, LS7184": ("teensy32", {"decoder": '"ls7184_x4"\ncounter = "hardware"'}, ""),
    "ENC1, channels": ("teensy41", {"decoder": '"hardware"'}, ""),
    "ENC1 on other pins": ("teensy40", {"decoder": '"hardware"'}, "encoder_step = 33\nencoder_dir = 0"),
    "ENC1, LS7184": ("teensy40", {"decoder": '"ls7184_x4"\ncounter = "hardware"'}, ""),
}


def with_counter(name: str, base: str = "hobbing_plewes") -> HobbingMachine:
    board, changes, pins = COUNTERS[name]
    text = bundled(f"{base}.toml").read_text("utf-8")
    for key, value in {"board": f'"{board}"', **changes}.items():
        text = re.sub(rf"^{key} = .*$", f"{key} = {value}", text, count=1, flags=re.MULTILINE)
    return parse(text.replace("[pins]\n", f"[pins]\n{pins}\n"), HobbingMachine, name)


@pytest.mark.parametrize("name", COUNTERS)
def test_counter_of_the_board_loses_nothing_where_it_runs_over(name: str, power_up: Callable[..., Board]) -> None:
    """Registers as the reference manuals describe them: over 0 and 65536 both ways, and to and fro on both; read after
    every edge, and after as many as come between two ticks or more."""
    given = at_once(with_counter(name))
    board = power_up(given)
    board.start()
    steps_per_edge = Fraction(16000, 24 * 4096)
    random, turned = np.random.default_rng(7), 0

    def drive(edges: int, ticks: int) -> None:
        nonlocal turned
        board.hob(abs(edges), edges > 0, ticks)
        turned += edges

    def check() -> None:
        board.wait(20)
        assert abs(board.board.board_position() - turned * steps_per_edge) <= Fraction(1, 2), turned

    tick_us = given.tick_ns // 1000
    for place in (-3, 65533, 131_070, 65_540, 2, -65_538):
        drive(place - turned, 20 // tick_us)
        check()
        for edges in random.integers(-9, 10, 60).tolist():
            if edges:
                drive(edges, int(random.choice([0, 1, 5])))  # 0: all of them between two readings
                board.board.board_pass(1)
        drive(place - turned, 20 // tick_us)
        check()
    assert board.board.board_bad_pulses() == 0


@pytest.mark.parametrize("name", ["FTM2, channels", "FTM1, LS7184", "ENC1, LS7184"])
def test_counters_compile_for_their_board(name: str, tmp_path: Path, arm: str) -> None:
    given = with_counter(name)
    folder = write(teensy_files(given), tmp_path / "gearbox")
    defines, processor, _ = BOARDS[given.board]
    run(
        folder,
        f"{arm}g++",
        *processor,
        "-mthumb",
        *CXX,
        *STRICT,
        *defines,
        f"-I{STAND_IN}",
        "-fsyntax-only",
        "sketch.cpp",
    )


def test_feed_has_a_counter_of_its_own(power_up: Callable[..., Board]) -> None:
    text = bundled("hobbing_helical.toml").read_text("utf-8").replace('"ls7184_x4"', '"hardware"')
    given = parse(text.replace("feed_step = 10\nfeed_dir = 11", "feed_step = 30\nfeed_dir = 31"), HobbingMachine, "m")
    assert (given.hob_counter.unit, given.feed_counter.unit) == (1, 3)
    board = power_up(given)
    for _ in range(12):
        if board.display()[0].startswith("Helix none"):
            break
        board.press()
    board.knob(8)
    board.start()
    up = int(not given.feed_climbs)
    board.board.board_feed(ctypes.c_long(70_000), up, ctypes.c_long(10))
    board.wait(5)
    # 0.08 degrees (the knob's 8 detents): 16 steps/mm over the lead, 70 mm of feed
    there = board.board.board_position()
    assert there > 0
    board.board.board_feed(ctypes.c_long(70_000), 1 - up, ctypes.c_long(10))
    board.wait(5)
    assert board.board.board_position() == 0


def test_feed_counts_turn_the_table_forward_in_a_conventional_cut(power_up: Callable[..., Board]) -> None:
    """Right-hand helix, right-hand hob: T = (k/z) H / (1 - f/L), so travel in the conventional direction adds."""
    given = machine("hobbing_helical")
    board = power_up(given)
    for _ in range(12):
        if board.display()[0].startswith("Helix none"):
            break
        board.press()
    board.knob(8)
    assert board.display()[0].startswith("Right hand"), board.display()
    board.start()
    up = int(not given.feed_climbs)
    board.board.board_feed(ctypes.c_long(2000), up, ctypes.c_long(50))
    board.wait(5)
    assert board.board.board_position() > 0
    board.board.board_feed(ctypes.c_long(2000), 1 - up, ctypes.c_long(50))
    board.wait(5)
    assert board.board.board_position() == 0


@pytest.mark.parametrize(("name", "after"), [("hobbing_plewes", 37), ("hobbing_plewes", 598), ("lathe_example", 411)])
def test_a_stuck_display_delays_neither_a_stop_nor_the_job(
    name: str, after: int, power_up: Callable[..., Board]
) -> None:
    """Every call to the display lasts 600 ms; the press is obeyed in 20 ms of debouncing and 5 ms, 50 at most."""
    given = at_once(with_pins(machine(name), index=None))  # the stand-in's hob turns without one
    board = power_up(given)
    board.start()
    tick_us = given.tick_ns // 1000
    board.board.board_turn_hob(ctypes.c_long(200 // tick_us))  # 5000 edges/s
    board.wait(300)
    assert board.display()[3].startswith("In phase: lag")
    board.press()
    board.knob(1)
    assert board.display()[3].startswith("Stop?     no  >yes<")
    board.board.board_bus(1)
    assert 10 <= board.board.board_press_and_count(ctypes.c_long(after), ctypes.c_long(1500)) <= 50
    board.board.board_bus(0)
    board.board.board_turn_hob(ctypes.c_long(0))
    board.wait(1500)
    assert board.display()[0] == "STOPPED, phase kept"
    assert board.board.board_bad_pulses() == 0


def test_display_is_begun_anew_while_the_job_runs(power_up: Callable[..., Board]) -> None:
    """Garbage: by turning the knob while the button is held; a display that was away: by itself. The phase stays."""
    board = power_up(at_once(machine("hobbing_plewes")))
    board.start()
    board.board.board_turn_hob(ctypes.c_long(40))
    board.wait(300)
    shown, starts = board.display(), board.board.board_starts()
    board.board.board_garbage()
    assert board.display() != shown
    board.board.board_button(1)
    board.wait(60)
    board.knob(1)
    board.board.board_button(0)
    board.wait(600)
    assert board.display()[0] == shown[0]
    assert board.display()[3].startswith("In phase: lag")  # the page did not change either
    assert board.board.board_starts() == starts + 1
    board.board.board_display_off(1)
    board.wait(2500)
    board.board.board_garbage()
    board.board.board_display_off(0)
    board.wait(2500)
    assert board.display()[0] == shown[0]
    assert board.display()[3].startswith("In phase: lag")


def test_display_that_is_plugged_in_later_is_found(power_up: Callable[..., Board]) -> None:
    board = power_up(machine("lathe_example"), display_off=True)
    assert not any("PHASE" in line for line in board.display())
    board.board.board_display_off(0)
    board.wait(2500)
    assert board.display()[2] == "PHASE IS LOST"


@pytest.mark.parametrize(("name", "timeout"), [("hobbing_plewes", 500), ("lathe_example", 1000)])
def test_watchdog_is_refreshed_only_while_every_part_works(name, timeout, power_up: Callable[..., Board]) -> None:
    board = power_up(machine(name))
    assert board.board.board_watchdog_ms() == timeout
    # MK20: LVDRE is bit 4, the high one of both thresholds (2.56 V) LVDV = 1
    assert board.board.board_brown_out() == (0x11 if name == "hobbing_plewes" else -1)
    for _ in range(20):
        board.wait(20)
        assert board.board.board_refreshed()
    for part in (1, 2, 3):  # step timer, operator, loop; the last may wait 8 s for a display
        board.board.board_hang(part, ctypes.c_long(8100 if part == 3 else 50))
        board.board.board_refreshed()
        board.board.board_hang(part, ctypes.c_long(1000))
        assert not board.board.board_refreshed()
        board.wait(50)
        assert board.board.board_refreshed()


def test_edges_and_ticks_have_one_priority(power_up: Callable[..., Board]) -> None:
    for name in ("hobbing_plewes", "hobbing_helical"):
        board, given = power_up(machine(name)), machine(name)
        assert board.board.board_priority(0) == board.board.board_priority(1) == 16
        assert board.board.board_priority(2) == 208  # knob, button and pages: below everything else
        assert board.board.board_tick_us() * 1000 == given.tick_ns
        for pin in (given.pins.step_out, given.pins.dir_out):
            assert board.board.board_mode(pin) == 1  # OUTPUT
        assert board.board.board_mode(given.pins.button) == 2  # INPUT_PULLUP


def test_display_is_written_only_where_its_text_changed(power_up: Callable[..., Board]) -> None:
    board = power_up(machine("hobbing_plewes"))
    assert board.display() == ["No stored job", " 24 teeth      32 DP", "PHASE IS LOST", "Press: check the job"]
    written = board.board.board_writes()
    assert written == sum(not letter.isspace() for row in board.display() for letter in row)
    board.wait(2000)
    assert board.board.board_writes() == written


def test_confirmed_job_comes_back_after_power_off_and_its_phase_does_not(power_up: Callable[..., Board]) -> None:
    first = power_up(machine("hobbing_plewes"))
    first.press()
    first.knob(7)
    first.start()
    first.wait(1500)
    assert first.board.board_eeprom_writes() == 40
    again = power_up(machine("hobbing_plewes"), first.eeprom())
    assert again.display() == ["Last job restored", " 31 teeth      32 DP", "PHASE IS LOST", "Press: check the job"]
    again.hob(4096)
    again.wait(10)
    assert again.board.board_position() == 0  # nothing moves before a confirmation


def test_power_lost_at_any_moment_of_a_day_leaves_the_job_before_or_the_new_one(power_up: Callable[..., Board]) -> None:
    """A first job, a stop, another job, an emergency stop, a third one. Only the EEPROM outlives the power, so that the
    moments differ by its bytes: the power is lost after each one that is written, and returns with the hob turning."""
    given = at_once(machine("hobbing_default"))
    board = power_up(given)
    board.press()
    board.start()
    board.wait(1500)
    for stopped, teeth in ((False, 5), (True, 3)):
        board.hob(2000)
        if stopped:
            board.board.board_estop(1)
            board.wait(50)
            board.board.board_estop(0)
            board.wait(1500)
            assert board.display()[0] == "EMERGENCY STOP"
            board.press(1200)  # held: acknowledged
        else:
            board.press()
            board.knob(1)
            board.press()  # Stop? yes
        assert board.display()[0] == "STOPPED, phase kept"
        board.knob(3)
        assert board.display()[3] == ">new job"
        board.press()
        board.knob(teeth)
        board.start()
        board.wait(1500)
    image, shown = bytearray(b"\xff" * 4284), []
    for k in range(-1, board.board.board_eeprom_writes()):
        if k >= 0:
            image[board.board.board_eeprom_log(k, 0)] = board.board.board_eeprom_log(k, 1)
        again = power_up(given, bytes(image), hob_every=20, wait=120)
        levels = {again.board.board_level(given.pins.healthy) for _ in range(3) if again.wait(1) is None}
        assert levels == {0}
        assert (again.board.board_position(), again.board.board_bad_pulses()) == (0, 0)
        assert again.display()[2:] == ["PHASE IS LOST", "Press: check the job"]
        if again.display()[:2] not in shown:
            shown.append(again.display()[:2])
        assert again.display()[:2] == shown[-1]  # never back to a job before
    assert board.eeprom() == bytes(image)
    restored = [["Last job restored", f"{teeth:3} teeth     0.5 m"] for teeth in (24, 29, 32)]
    assert shown == [["No stored job", " 24 teeth     0.5 m"], *restored]


def test_nothing_is_written_to_the_eeprom_while_the_hob_turns(power_up: Callable[..., Board]) -> None:
    board = power_up(machine("lathe_example"))
    for _ in range(40):  # the spindle runs already when the job is confirmed
        board.hob(40, ticks=10)
        board.wait(30)
    board.start()
    before = board.board.board_eeprom_writes()
    for _ in range(50):
        board.hob(40, ticks=10)
        board.wait(30)
    assert board.board.board_eeprom_writes() == before


def test_open_emergency_stop_ends_on_the_fault_page_and_lets_the_relay_go(power_up: Callable[..., Board]) -> None:
    given = machine("hobbing_helical")
    board = power_up(given)

    def levels() -> set[int]:
        seen = set()
        for _ in range(20):
            board.wait(1)
            seen.add(board.board.board_level(given.pins.healthy))
        return seen

    assert levels() == {0}  # after power-up only the operator lets it go on
    board.start()
    board.hob(1, ticks=137)
    seen = set()
    for _ in range(20):  # half periods of 0.5 ms: looked at every 0.7 ms
        board.hob(1, ticks=350)
        seen.add(board.board.board_level(given.pins.healthy))
    assert seen == {0, 1}
    board.board.board_estop(1)
    board.wait(500)
    assert board.display()[0] == "EMERGENCY STOP"
    assert levels() == {0}
    still = board.board.board_position()
    board.hob(4096, ticks=20)
    assert board.board.board_position() == still


def test_bursts_on_knob_and_button_disturb_no_job(power_up: Callable[..., Board]) -> None:
    """1 ms on the button is no press; a knob that counts to and fro turns pages at the most."""
    board = power_up(at_once(machine("hobbing_plewes")))
    board.start()
    board.board.board_turn_hob(ctypes.c_long(40))
    board.wait(300)
    for k in range(40):
        board.board.board_button(1)
        board.wait(1)
        board.board.board_button(0)
        board.wait(1 + k % 7)
        board.knob(1 - 2 * (k % 2))
    board.wait(500)
    assert board.display()[3].startswith("In phase: lag")
    board.board.board_turn_hob(ctypes.c_long(0))
    board.wait(100)
    assert board.board.board_bad_pulses() == 0


def test_button_bounces_and_long_presses_are_told_apart(power_up: Callable[..., Board]) -> None:
    board = power_up(machine("hobbing_plewes"))
    shown = board.display()
    board.press(5)  # a bounce
    assert board.display() == shown
    board.press(100)
    assert board.display()[0].startswith("Teeth")
    board.press(1500)  # a long press: back to the menu
    assert board.display()[0] == "Menu"
