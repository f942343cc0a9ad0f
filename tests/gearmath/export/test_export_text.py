"""The text of the generated C: what it says, what it refuses, and that it is the same everywhere."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import casadi as ca
import pytest
from hypothesis import given
from hypothesis import strategies as st

from derivations import gearbox
from derivations.expression import Quantity
from gearmath.engine.kernel import Kernel
from gearmath.errors import InputError
from gearmath.export.c import ExportError, contract_files, double_kernel, integer_kernel
from gearmath.export.cnc import cnc_kernels
from gearmath.export.header import comment, kernel_comment
from gearmath.front.exports import export_c
from gearmath.lowering import lower


def whole(name: str) -> Quantity:
    return Quantity(name, "a whole number", "1", name, (0, 9), kind="int")


def tiny(build) -> Kernel:
    """A Kernel of two whole numbers a and b with one output."""
    a, b = ca.SX.sym("a"), ca.SX.sym("b")
    function = ca.Function("tiny", [a, b], [build(a, b)], ["a", "b"], ["c"])
    return Kernel(function, "A test.", (whole("a"), whole("b")), (whole("c"),))


@pytest.mark.parametrize(
    ("operation", "build"),
    [
        ("TWICE", lambda a, b: 2 * a),
        ("TWICE", lambda a, b: a + a),
        ("FLOOR", lambda a, b: ca.floor(a)),
        ("DIV", lambda a, b: a / b),
        ("FMIN", lambda a, b: ca.fmin(a, b)),
        ("FABS", lambda a, b: ca.fabs(a)),
        ("FMOD", lambda a, b: ca.fmod(a, b)),
        ("INV", lambda a, b: 1 / a),
    ],
)
def test_operation_that_is_not_exact_in_integers_is_refused_by_name(operation: str, build) -> None:
    with pytest.raises(ExportError, match=rf"^tiny: {operation} is not exact in integer C"):
        integer_kernel(tiny(build))


@pytest.mark.parametrize(
    ("constant", "bits"),
    [(0.5, 32), (2.0**31, 32), (-(2.0**40), 32), (2.0**53, 64), (float("inf"), 32), (float("nan"), 64)],
)
def test_constant_that_does_not_fit_is_refused(constant: float, bits: int) -> None:
    with pytest.raises(ExportError, match="is no whole number of"):
        integer_kernel(tiny(lambda a, b: a + b * constant), bits)


def test_real_quantity_is_refused_in_an_integer_kernel() -> None:
    with pytest.raises(ExportError, match="gearbox_ratio: pulse_ratio is no whole number"):
        integer_kernel(lower(gearbox.gearbox_ratio()))


def test_integer_kernel_holds_no_floating_constant_and_no_floating_type() -> None:
    kernel = integer_kernel(tiny(lambda a, b: a * 3 + ca.if_else(b > 7, a - 12345678, 1073741824)))
    code = re.sub(r"/\*.*?\*/", "", kernel.header + kernel.source, flags=re.DOTALL)
    assert not re.search(r"\d\.|\.\d|\d[eE][+-]?\d|double|float|math\.h", code)
    assert "=1073741824;" in code


@pytest.mark.parametrize("constant", [10**15, -(2**53) + 1, 2**52 + 3])
def test_large_constant_of_a_64_bit_kernel_is_written_exactly(constant: int) -> None:
    source = integer_kernel(tiny(lambda a, b: a + b * constant), 64).source
    assert f"={constant};" in source


@pytest.mark.parametrize("name", ["int", "arg", "NAN", "class", "linux", "NULL", "GM_OK", "casadi_real"])
def test_name_that_c_has_taken_is_refused(name: str) -> None:
    a = ca.SX.sym("a")
    kernel = Kernel(ca.Function("tiny", [a], [a], [name], ["c"]), "A test.", (whole(name),), (whole("c"),))
    for export in (double_kernel, integer_kernel):
        with pytest.raises(ExportError, match=f"the name {name} is taken in C"):
            export(kernel)


def test_a_kernel_cannot_take_the_place_of_a_file_or_function_of_the_library() -> None:
    own = set(re.findall(r"\bgm_(\w+)", "".join((*contract_files(), *contract_files().values())))) - {"h"}
    assert {"status", "check", "version", "nan"} <= own
    for name in sorted(own):
        a = ca.SX.sym("a")
        kernel = Kernel(ca.Function(name, [a], [a], ["a"], ["c"]), "A test.", (whole("a"),), (whole("c"),))
        with pytest.raises(ExportError, match=f"gm_{name} is part of the library"):
            double_kernel(kernel)


def test_kernels_that_would_write_over_each_other_are_refused(tmp_path: Path) -> None:
    def named(name: str) -> Kernel:
        a = ca.SX.sym("a")
        return Kernel(ca.Function(name, [a], [a], ["a"], ["c"]), "A test.", (whole("a"),), (whole("c"),))

    for pair in (("cut", "cut"), ("cut", "Cut"), ("cut", "cut_batch")):
        with pytest.raises(InputError, match="would both become gm_cut"):
            export_c([named(name) for name in pair], tmp_path / "c")
    assert not (tmp_path / "c").exists()


def test_what_casadi_cannot_write_as_c_is_refused_by_name(capfd: pytest.CaptureFixture) -> None:
    a, b = ca.SX.sym("a"), ca.SX.sym("b")
    solver = ca.rootfinder("solver", "newton", ca.Function("g", [a, b], [a**2 - b]))
    given_ = ca.MX.sym("b")
    kernel = Kernel(
        ca.Function("tiny", [given_], [solver(1, given_)], ["b"], ["c"]), "A test.", (whole("b"),), (whole("c"),)
    )
    with pytest.raises(ExportError, match="tiny: Code generation not supported for Newton"):
        double_kernel(kernel)
    assert "ops: not counted" in kernel_comment(kernel, "")


def test_unknown_form_of_the_c_of_another_casadi_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    class Stranger(ca.CodeGenerator):
        def dump(self) -> str:
            return super().dump().replace("/* Configuration", "/* Settings")

    monkeypatch.setattr(ca, "CodeGenerator", Stranger)
    with pytest.raises(ExportError, match=r"tiny: the C of CasADi .* has an unknown form"):
        double_kernel(tiny(lambda a, b: a + b))


_HARD = st.lists(
    st.one_of(st.sampled_from(["*/", "/*", "\\", "??/", "?", "*", "/", "\n", "\r", "\0", "\u202e"]), st.text()),
    max_size=20,
)


@given(_HARD.map("".join))
def test_free_text_cannot_break_out_of_a_comment(text: str) -> None:
    written = comment([text, f"  {text}"])
    assert written.startswith("/*\n")
    assert written.endswith("\n */\n")
    inside = written[2:-4]
    assert "*/" not in inside
    assert "/*" not in inside
    assert "\\" not in inside
    assert "??" not in inside
    assert all(letter.isprintable() or letter == "\n" for letter in inside)
    assert all(line.startswith(" *") for line in inside.split("\n")[1:-1])


def test_header_carries_units_domain_source_versions_and_operations() -> None:
    (kernel,) = (kernel for kernel in cnc_kernels() if kernel.name == "axis_transform")
    text = double_kernel(kernel).header
    for wanted in (
        "generated, do not edit",
        "[7] machine_root_angle [rad] -0.2 ... 1.45 (taken: -1.57079632679 ... 1.57079632679): work axis against",
        "out axes[5] [mixed]: axis positions",
        "requires: sqrt(",
        "source: Coordinate Control Method",
        "work memory: none",
        "casadi 3.",
        "atan2 2",
    ):
        assert wanted in text
    assert re.search(r"ops: \d+ \(add \d+, ", text)
    assert not re.search(r"20\d\d-\d\d|/home|/work|/tmp", text)


def test_operation_count_is_the_number_of_operations_in_the_c() -> None:
    for kernel in cnc_kernels():
        if not kernel.function.is_a("SXFunction"):
            continue  # composed: its text calls a step that is written once and run several times
        c = double_kernel(kernel)
        (count,) = re.findall(r"ops: (\d+)", c.header)
        lines = re.findall(r"^  a\d+=(.*);$", c.source, flags=re.MULTILINE)
        done = [line for line in lines if not re.fullmatch(r"arg\[.*|-?\d+\.\d*(e[+-]\d+)?|a\d+", line)]
        assert int(count) == len(done), kernel.name


def test_text_does_not_depend_on_the_hash_seed() -> None:
    program = (
        "import hashlib; from gearmath.export.cnc import cnc_files; from gearmath.export.teensy import teensy_files;"
        "from gearmath.specs.hobbing import load_hobbing_machine; from gearmath.specs.toml import bundled;"
        "files = cnc_files() | teensy_files(load_hobbing_machine(bundled('hobbing_plewes.toml')));"
        "print(hashlib.sha256(repr(sorted(files.items())).encode()).hexdigest())"
    )
    hashes = set()
    for seed in ("1", "2"):
        environment = os.environ | {"PYTHONHASHSEED": seed}
        done = subprocess.run(
            [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True
        )
        hashes.add(done.stdout)
    assert len(hashes) == 1
