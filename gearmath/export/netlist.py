"""What is connected with what on one machine: its parts and its nets, from which the README's lists are made.

A net joins ends, each a pin of a part; no pin is in two nets. The wiring diagram is drawn by ``wiring.py``; a test
reads its lines back and compares them with these nets.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from gearmath.specs.hobbing import HobbingMachine

End = tuple[str, str]
PLUS, LOGIC, GROUND = "+5 V", "+3.3 V", "0 V"
#: Input and output pin of channel k of a 74LVC245, A to B; 1 is DIR, 19 is OE, 10 GND, 20 VCC.
_SHIFTER_IN, _SHIFTER_OUT = range(2, 10), range(18, 10, -1)
#: Fuses 5 x 20 mm, slow [mA], and how much more than the largest current one must carry.
_FUSES, _SPARE = (315, 400, 500, 630, 800, 1000, 1250, 1600), 1.25
#: Ends of the windings of a step motor.
WINDINGS = ("A+", "A-", "B+", "B-")


@dataclass(frozen=True)
class NetPart:
    """One part: its name in diagram and tables, what to buy, what for, and the current it takes from +5 V [mA]."""

    name: str
    what: str
    purpose: str
    current: int = 0


@dataclass
class Netlist:
    """Parts by name, nets by name."""

    parts: dict[str, NetPart] = field(default_factory=dict)
    nets: dict[str, list[End]] = field(default_factory=dict)

    def part(self, name: str, what: str, purpose: str, current: int = 0) -> str:
        self.parts[name] = NetPart(name, what, purpose, current)
        return name

    def join(self, net: str, *ends: End) -> None:
        self.nets.setdefault(net, []).extend(ends)

    @property
    def current(self) -> int:
        """What the regulator has to give [mA]."""
        return sum(part.current for part in self.parts.values())


def netlist(machine: HobbingMachine) -> Netlist:
    """Parts and nets of the machine, low voltage only; the contactor's circuit is drawn by itself."""
    found = Netlist()
    _supply(found, machine)
    _encoders(found, machine)
    _operator(found, machine)
    _driver(found, machine)
    if machine.pins.healthy is not None:
        _pump(found, machine.pins.healthy, _outputs(machine) + 1)
    _motor(found, machine)
    _supplies(found)
    return found


def fuse_milliamperes(current: int) -> int:
    """Fuse [mA] for parts that take so many mA."""
    return next(one for one in _FUSES if one >= _SPARE * current)


def supply_amperes(current: int) -> float:
    """Current [A] of the supply for parts that take so many mA: half more than their fuse, which must blow first."""
    return -(-fuse_milliamperes(current) * 15 // 1000) / 10


def _board(pin: int) -> End:
    return ("U1", str(pin))


def _outputs(machine: HobbingMachine) -> int:
    return 2 + (machine.pins.enable is not None)


def _bypass(found: Netlist, chip: str, net: str) -> None:
    """100 nF between the supply pins of a chip."""
    pins = "OUT and GND" if chip == "U2" else "the supply pins"
    name = found.part(f"CB{chip[1:]}", "100 nF, ceramic", f"between {pins} of {chip}, as near as possible")
    found.join(net, (name, "1"))
    found.join(GROUND, (name, "2"))


def _supply(found: Netlist, machine: HobbingMachine) -> None:
    old = machine.board == "teensy32"
    board = machine.hardware.title
    if old:
        board += ', used or from old stock, since it is made no longer; or `board = "teensy40"` in the machine file'
    found.part("U1", board, "the board", 50 if old else 110)
    found.part("U2", "LM7805, TO-220", "5 V from the supply")
    for name, side in (("C1", "input"), ("C2", "output")):
        found.part(name, "10 uF 25 V, electrolytic, + to the supply", f"at the {side} of U2, within 20 mm")
    _bypass(found, "U2", PLUS)
    found.join("supply", ("U2", "1 IN"), ("C1", "+"))
    found.join(PLUS, ("U2", "3 OUT"), ("C2", "+"), ("U1", "Vin"))
    found.join(GROUND, ("U2", "2 GND"), ("C1", "-"), ("C2", "-"), ("U1", "GND"))


def _supplies(found: Netlist) -> None:
    """Supply of the circuit and its fuse, for the current of all parts."""
    found.part("G1", f"supply, 9 V DC, {supply_amperes(found.current):.1f} A or more", "the circuit, by U2")
    found.part(
        "F2", f"fuse {fuse_milliamperes(found.current)} mA slow, 5 x 20 mm, with holder", "between + of G1 and U2"
    )
    found.join("9 V", ("G1", "+"), ("F2", "1"))
    found.join("supply", ("F2", "2"))
    found.join(GROUND, ("G1", "-"))


def _motor(found: Netlist, machine: HobbingMachine) -> None:
    """Motor, and the power of its driver, which has nothing in common with that of the circuit."""
    drive = machine.drive
    servo = drive.pulses is not None
    kind = "servo motor of the drive A2" if servo else f"step motor, {drive.full_steps} full steps a turn"
    if not servo and machine.driver.timing.closed_loop:
        kind = f"closed-loop {kind}, with the encoder and the encoder cable that belong to A2"
    found.part("M1", f"{kind}; torque and current: by the machine, and within the driver", "turns what is geared")
    for end in motor_cables(machine):
        found.join(f"motor {end}" if not servo else end, ("A2", end), ("M1", end))
    found.part("G2", "supply of the motor: voltage and current by the data sheets of driver and motor", "A2 alone")
    found.part("F3", "fuse as the data sheet of the driver asks for, with holder", "between + of G2 and A2")
    found.join("motor supply", ("G2", "+"), ("F3", "1"))
    found.join("motor power", ("F3", "2"), ("A2", "power +"))
    found.join("motor power -", ("G2", "-"), ("A2", "power -"))


def _encoders(found: Netlist, machine: HobbingMachine) -> None:
    pins, shifted = machine.pins, not machine.hardware.five_volt_tolerant
    signals: list[tuple[str, End, int]] = []
    lines = f"{machine.encoder.lines} lines, 5 V, channels A and B" + " and index Z" * (pins.index is not None)
    spindle = "spindle" if machine.profile == "lathe" else "hob"
    encoders = [("B1", lines, f"{spindle} encoder", pins.encoder_step, pins.encoder_dir, pins.index, "U3", "RB1")]
    if machine.feed is not None and pins.feed_step is not None and pins.feed_dir is not None:
        feed = f"{machine.feed.counts_per_mm} counts per mm after its decoder, 5 V, channels A and B"
        encoders.append(("B2", feed, "encoder of the axial feed", pins.feed_step, pins.feed_dir, None, "U4", "RB2"))
    for name, what, purpose, first, second, index, chip, bias in encoders:
        found.part(name, f"encoder, {what}", purpose, 80)
        found.join(PLUS, (name, "+5 V"))
        found.join(GROUND, (name, "0 V"))
        if index is not None:
            signals.append((f"{name} index", (name, "Z"), index))
        if not machine.encoder.has_ls7184:
            signals += [(f"{name} A", (name, "A"), first), (f"{name} B", (name, "B"), second)]
            continue
        _decoder(found, machine, name, chip, bias)
        signals += [(f"{name} pulse", (chip, "8 CLK"), first), (f"{name} direction", (chip, "7 UP/DN"), second)]
    if shifted:
        found.part("U5", "SN74LVC245AN, DIP-20", "5 V to 3.3 V, A to B; fast enough for pulses of 200 ns")
        found.join(LOGIC, ("U1", "3.3V"), ("U5", "20 VCC"), ("U5", "1 DIR"))
        found.join(GROUND, ("U5", "10 GND"), ("U5", "19 OE"))
        _bypass(found, "U5", LOGIC)
    for k, (net, end, pin) in enumerate(signals):
        if not shifted:
            found.join(net, end, _board(pin))
            continue
        found.join(f"{net}, 5 V", end, ("U5", f"{_SHIFTER_IN[k]} A{k + 1}"))
        found.join(net, ("U5", f"{_SHIFTER_OUT[k]} B{k + 1}"), _board(pin))
    for k in range(len(signals), 8 if shifted else 0):
        found.join(GROUND, ("U5", f"{_SHIFTER_IN[k]} A{k + 1}"))


def _decoder(found: Netlist, machine: HobbingMachine, encoder: str, chip: str, bias: str) -> None:
    found.part(chip, "LS7184N, DIP-8", f"decoder of {encoder}", 5)
    found.part(bias, "see Encoder and decoder", f"length of the output pulse of {chip}")
    found.join(f"{encoder} A", (encoder, "A"), (chip, "4 A"))
    found.join(f"{encoder} B", (encoder, "B"), (chip, "5 B"))
    found.join(f"{chip} bias", (chip, "1 RBIAS"), (bias, "1"))
    found.join(PLUS, (chip, "2 VDD"))
    found.join(GROUND, (chip, "3 VSS"), (bias, "2"))
    if machine.encoder.edges_per_line != 4:
        found.join(GROUND if machine.encoder.edges_per_line == 1 else PLUS, (chip, "6 MODE"))
    _bypass(found, chip, PLUS)


def _operator(found: Netlist, machine: HobbingMachine) -> None:
    pins = machine.pins
    knob = "rotary knob with button, 24 detents and 24 pulses a turn, 4 edges a detent (PEC11R-4220F-S0024)"
    found.part("S1", knob, "the operator's knob")
    for net, end, pin in (("knob A", "A", pins.knob_a), ("knob B", "B", pins.knob_b), ("button", "D", pins.button)):
        found.join(net, ("S1", end), _board(pin))
    found.join(GROUND, ("S1", "C"), ("S1", "E"))
    chip = {"adafruit292": "Adafruit 292 (MCP23008)", "pcf8574": "PCF8574"}[machine.display.kind]
    found.part(
        "H1",
        f"LCD, 4 x 20 characters, 5 V, with I2C backpack {chip}",
        f"address 0x{machine.display.i2c_address:02X}",
        120,
    )
    found.join(PLUS, ("H1", "VCC"))
    found.join(GROUND, ("H1", "GND"))
    direct = machine.hardware.five_volt_tolerant
    if not direct:
        found.part("U6", "BSS138 level shifter, board with 2 channels or more", "I2C between 3.3 V and 5 V")
        found.join(LOGIC, ("U6", "LV"))
        found.join(PLUS, ("U6", "HV"))
        found.join(GROUND, ("U6", "GND"))
    for k, (line, pin) in enumerate((("SDA", pins.sda), ("SCL", pins.scl)), start=1):
        pull_up = found.part(
            f"RP{k}", "4.7 kOhm", f"pull-up of {line} at the board; leave it out if the backpack has one"
        )
        found.join(PLUS if direct else LOGIC, (pull_up, "1"))
        found.join(line, _board(pin), (pull_up, "2"), ("H1", line) if direct else ("U6", f"LV{k}"))
        if not direct:
            found.join(f"{line}, 5 V", ("U6", f"HV{k}"), ("H1", line))
    if pins.estop is not None:
        found.part(
            "S2", "emergency stop that latches, two normally closed contacts", "11-12 for power, 21-22 for the board"
        )
        found.join("emergency stop", ("S2", "22"), _board(pins.estop))
        found.join(GROUND, ("S2", "21"))


def _driver(found: Netlist, machine: HobbingMachine) -> None:
    pins, opened = machine.pins, machine.driver.output == "open_collector"
    found.part("A2", f"driver {machine.driver.name or 'of the machine file'}", "of the step motor")
    signals = [("STEP", pins.step_out), ("DIR", pins.dir_out)]
    if pins.enable is not None:
        signals.append(("ENABLE", pins.enable))
    for k, (name, pin) in enumerate(signals, start=1):
        if not opened:
            found.join(name, _board(pin), ("A2", f"{name}"))
            continue
        found.join(PLUS, ("A2", f"{name} +"))
        _transistor(found, k, name, _board(pin), ("A2", f"{name} -"), 10)
        found.part(f"RL{k}", "plain wire, or 330 Ohm: see below", f"in the collector of T{k}")
    if not opened:
        found.join(GROUND, ("A2", "common"))
    for name, wired in straight(machine):
        found.join(name.lower(), ("A2", f"{name} +"), _board(wired))
        found.join(GROUND, ("A2", f"{name} -"))


def straight(machine: HobbingMachine) -> list[tuple[str, int]]:
    """Names and pins of what goes to the driver without a transistor; the other end of each is 0 V."""
    pins = machine.pins
    return [(name, pin) for name, pin in (("ALARM", pins.alarm), ("RESET", pins.reset)) if pin is not None]


def motor_cables(machine: HobbingMachine) -> tuple[str, ...]:
    """What goes from the driver to the motor."""
    if machine.drive.pulses is not None:
        return ("motor cable",)
    return (*WINDINGS, "encoder") if machine.driver.timing.closed_loop else WINDINGS


def _transistor(found: Netlist, k: int, name: str, source: End, load: End, current: int) -> None:
    """An NPN transistor that pulls its load to ground; in front of STEP, DIR and ENABLE with RL in the collector."""
    found.part(f"T{k}", "2N2222", f"open collector for {name}", current)
    found.part(f"R{k}", "1 kOhm", f"base of T{k}")
    found.join(f"{name} out", source, (f"R{k}", "1"))
    found.join(f"T{k} base", (f"R{k}", "2"), (f"T{k}", "B"))
    found.join(GROUND, (f"T{k}", "E"))
    if load[0] == "A2":
        found.join(f"T{k} collector", (f"T{k}", "C"), (f"RL{k}", "1"))
        found.join(f"{name} -", (f"RL{k}", "2"), load)
    else:
        found.join(f"{name} -", (f"T{k}", "C"), load)


def _pump(found: Netlist, pin: int, k: int) -> None:
    found.part("RC3", "100 Ohm", f"charge pump: limits the current of pin {pin} as C3 is charged")
    found.part("C3", "2.2 uF, ceramic", "charge pump: only a square wave of the board holds K1")
    found.part("C4", "10 uF 25 V, electrolytic", "charge pump, its store")
    for name in ("D1", "D2"):
        found.part(name, "1N5819", "charge pump")
    found.part("K1", "5 V relay of at most 50 mA, contact for the coil of the contactor", "lets the motor run", 50)
    found.part("D3", "1N4148", "across the coil of K1, its ring to +5 V")
    found.join("wave", _board(pin), ("RC3", "1"))
    found.join("limited wave", ("RC3", "2"), ("C3", "1"))
    found.join("pump", ("C3", "2"), ("D1", "cathode"), ("D2", "anode"))
    found.join("pumped", ("D2", "cathode"), ("C4", "+"))
    found.join(GROUND, ("D1", "anode"), ("C4", "-"))
    _transistor(found, k, "K1", ("C4", "pumped"), ("K1", "A2"), 0)
    # the base resistor hangs on the store of the pump, not on a pin of the board
    found.nets["pumped"].append((f"R{k}", "1"))
    del found.nets["K1 out"]
    found.join("K1 -", ("D3", "anode"))
    found.join(PLUS, ("K1", "A1"), ("D3", "cathode"))
