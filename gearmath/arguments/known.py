"""What the arguments of public functions may be, by their names: the one table, of Python and the command line.

Limits that depend on member, machine or job are not here: they are told where the work is done, in a sentence too.
"""

from __future__ import annotations

from gearmath.arguments.composed import Columns, Each, Either, Keyed, Pair
from gearmath.arguments.kinds import (
    Called,
    Content,
    Grid,
    Having,
    Kind,
    Number,
    OneOf,
    Place,
    Record,
    Text,
    Truth,
    Whole,
)

#: Touches of one point, and points of a grid; so much an assembly may be off [mm, degrees].
MOST_TOUCHES, MOST_POINTS = 100, 1_000_000
MOST_MM, MOST_DEG = 50.0, 10.0
#: Steps [degrees of the pinion] that a path of contact may be told in.
LEAST_STEP, MOST_STEP = 0.01, 15.0

_RULES = ("exact", "ideal", "float")
_FILE = Place()
_WORK = Called()


def _or_file(home: str, name: str, said: str) -> Either:
    """A record, or the file that it is loaded from."""
    record = Record(home, name, said)
    return Either((record, _FILE), f"must be {said}, or its file")


SET = _or_file("gearmath.front.sets", "GearSet", "a gear set")
MEMBER = Record("gearmath.front.member", "Member", "a member of a gear set, such as load_set(...).pinion")
MEASUREMENT = _or_file("gearmath.front.measured", "Measurement", "a measurement")
MACHINE = _or_file("gearmath.front.machines", "Machine", "a machine")
PROBE = _or_file("gearmath.specs.calibration", "Calibration", "a probe")
SHOP = _or_file("gearmath.specs.simulated_machine", "SimulatedMachine", "a simulated shop")
HOBBER = _or_file("gearmath.specs.hobbing", "HobbingMachine", "a hobbing machine or lathe")
#: Where a record was read from.
ORIGIN = Record("pathlib", "Path", "the Path of a file")
KERNEL = Record("gearmath.engine.kernel", "Kernel", "a kernel")
EXPRESSION = Record("derivations.expression", "Expression", "an Expression")
_FLANKS = ("concave", "convex")
_FLANK = OneOf(_FLANKS, f"must be {' or '.join(_FLANKS)}")
_SETTINGS = Keyed("must be settings by their names, such as {'radial_distance': 0.05}")

KNOWN: dict[str, Kind] = {
    # files and folders, texts
    **dict.fromkeys(("path", "data", "resume", "model", "source"), _FILE),
    "folder": Place("must be the path of a folder"),
    "create": Truth(),
    "name": Text(),
    "file": Place("must be the name of a file"),
    "text": Content(),
    "points": Either(
        (
            Record("gearmath.front.measured", "Measurement", "a measurement"),
            Record("gearmath.specs.flank_csv", "FlankFile", "a flank file"),
            _FILE,
        ),
        "must be a measurement, or a flank file",
    ),
    # records
    **dict.fromkeys(("pair", "gear_set", "gear"), SET),
    "member": MEMBER,
    **dict.fromkeys(("measured", "mate", "milled"), MEASUREMENT),
    "again": Each(MEASUREMENT, "must be a list of measurements, or of their files"),
    "machine": MACHINE,
    "probe": PROBE,
    "shop": SHOP,
    "expression": EXPRESSION,
    # flanks and their settings
    "flank": _FLANK,
    **dict.fromkeys(_FLANKS, _SETTINGS),
    "grid": Grid(MOST_POINTS),
    "margin": Either(
        (Number(0.0, 0.5, below=True), Record("gearmath.specs.margins", "Margins", "margins")),
        "must be at least 0 and less than 0.5, or Margins",
    ),
    "places": Either(
        (_FILE, Columns(2, "")), "must be z_w and radius of each point [mm], as many of both, or a file of such lines"
    ),
    "columns": Whole(3, 400),
    "whole_member": Truth(),
    # contact
    **dict.fromkeys(("v", "h", "j"), Number(-MOST_MM, MOST_MM, "mm")),
    "shaft": Number(-MOST_DEG, MOST_DEG, "degrees"),
    "sides": Each(
        OneOf(("drive", "coast"), "must be of drive, coast"), "must be a list of sides, such as ('drive',)", 1
    ),
    "step": Number(LEAST_STEP, MOST_STEP, "degrees"),
    # programs
    "control": Text("must be the name of a control, such as 'sinumerik' or 'linuxcnc'"),
    "spaces": Each(Whole(), "must be a list of tooth spaces, such as [0]", once=True),
    **dict.fromkeys(("tolerance", "roughing_stock", "finishing_stock"), Number(unit="mm", finite=False)),
    **dict.fromkeys(("report_tolerance", "flank_tolerance"), Number(1e-5, 1.0, "mm")),
    "feed": Number(unit="mm/min", finite=False),
    "spindle_rpm": Number(0.0, unit="rpm", above=True),
    "dry_run": Truth(),
    "blocks": OneOf(("g1", "poly")),
    "cycle": OneOf(("tip", "axes")),
    "topography": Each(Whole(), "must be a list of teeth, such as (0,)", once=True),
    **dict.fromkeys(("registration", "lobing"), Truth()),
    "repeat": Whole(1, MOST_TOUCHES),
    "number": Whole(1, 99_999),
    "run": Whole(1, 999_999_999),
    # measurements and their correction
    **dict.fromkeys(("registered", "rotated", "higher_order", "advance", "leave_out"), Truth()),
    "settings": Either(
        (Text(), Each(Text(), "", 1)), "must be 'few', 'standard', 'all', the name of a setting, or a list of names"
    ),
    "objective": OneOf(("points", "surface")),
    "bounds": OneOf(("machine", "design")),
    "root_limit": Number(0.001, 2.0, "mm"),
    "noise_um": Number(0.0, 100.0, "um"),
    "thickness": Number(-0.5, 0.5, "mm"),
    "thickness_by": OneOf(("work_rotation_offset", "sliding_base")),
    "least": Number(0.0, 2.0, "mm"),
    "sigma_um": Number(0.0, 1000.0, "um", above=True),
    "draws": Whole(1000, 10_000_000),
    "seed": Whole(0),
    "workers": Whole(1, 1024),
    "executor": Having("submit", "must be an Executor, which has submit"),
    "unit": OneOf(("mm", "inch")),
    "frame": Record("gearmath.quality.foreign.points", "Frame", "a Frame"),
    "phase": OneOf(("common", "each", "kept")),
    "paths": Keyed(
        "must be files by flank and tooth, such as {('concave', 0): 'points.txt'}", Pair(_FLANK, Whole(0), ""), _FILE, 1
    ),
    # the electronic gearbox
    **dict.fromkeys(("teeth", "starts", "wanted"), Whole()),
    "pitch": Text("must be a pitch like '1.25mm' or '8tpi'"),
    "hob": Text("must be the name of a hob"),
    "hand": OneOf(("right", "left")),
    "cut": OneOf(("climb", "conventional")),
    "climb": Truth(),
    "helix": Number(unit="degrees"),
    **dict.fromkeys(("rpm", "run_up", "shift", "pin"), Number(finite=False)),
    "module": Number(0.1, 25.0, "mm"),
    "face_width": Number(1.0, 1000.0, "mm"),
    "hob_shift": Number(-500.0, 500.0, "mm"),
    "seconds": Number(0.0, 86_400.0, "s"),
    "length": Number(1.0, 3000.0, "mm"),
    **dict.fromkeys(("rule", "compare"), OneOf(_RULES)),
    "pattern": OneOf(("forward", "dither", "reversals")),
    **dict.fromkeys(("edges", "start"), Whole()),
    "trace": Record("gearmath.gearbox.simulation", "Trace", "a Trace"),
    # C
    "bits": OneOf((0, 32, 64)),
    # progress
    **dict.fromkeys(("begin", "progress", "say"), _WORK),
}
