"""The exported library as a whole: built, linked, run and refused the way that a machine builder would.

A compiler or emulator that is missing is named and skipped, and a failure in CI.
"""

from __future__ import annotations

import ctypes
import os
import re
import shutil
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from elftools.elf.elffile import ELFFile

from gearmath.bevel.pair import load_pair
from gearmath.export.cnc import cnc_kernels, export_cnc
from gearmath.export.post import post_file
from gearmath.machine.planning.cut_plan import CuttingJob, cutting_plan
from gearmath.machine.writing.cutting import program_of
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.toml import bundled

STRICT = ("-Wall", "-Wextra", "-Werror", "-pedantic", "-O1")
PASSED = r"libgearmath [\d.]+, interface 1: (\d+) numbers, (\d+) the same bit for bit"


def run(*command: str | Path, cwd: Path, status: int = 0) -> str:
    done = subprocess.run([str(part) for part in command], cwd=cwd, capture_output=True, text=True)
    assert done.returncode == status, done.stdout + done.stderr
    return done.stdout


def tool(name: str, package: str) -> str:
    path = shutil.which(name)
    if path is None:
        pytest.skip(f"needs {name} (Debian: apt install {package})")
    return str(path)


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory, gcc: str) -> Path:
    """The folder, built by its Makefile under strict C99, warnings being errors."""
    folder = tmp_path_factory.mktemp("exported") / "lib"
    export_cnc(folder)
    run("make", "-s", f"CC={gcc}", f"CFLAGS={' '.join(STRICT)}", "all", "selftest", cwd=folder)
    return folder


@pytest.fixture(scope="module")
def installed(library: Path) -> Path:
    prefix = library.parent / "installed"
    run("make", "-s", "install", f"PREFIX={prefix}", f"CFLAGS={' '.join(STRICT)}", cwd=library)
    return prefix


@pytest.fixture(scope="module")
def loaded(library: Path) -> ctypes.CDLL:
    found = ctypes.CDLL(str(library / "libgearmath.so.1"))
    found.gm_error_text.restype = ctypes.c_char_p
    return found


def everything_agrees(printed: str) -> bool:
    found = re.match(PASSED, printed)
    return found is not None and int(found[1]) > 1000 and "failures" not in printed


def test_selftest_gives_every_number_of_the_design_programs_bit_for_bit(library: Path) -> None:
    printed = run("./selftest", cwd=library)
    found = re.match(PASSED, printed)
    assert found is not None
    assert found[1] == found[2]
    assert int(found[1]) > 1000


def test_selftest_fails_where_the_library_computes_something_else(library: Path, tmp_path: Path, gcc: str) -> None:
    text = (library / "selftest_vectors.h").read_text()
    number = re.search(r"_expected\[\d+\] = \{\s*(-?\d+\.\d+)", text)
    assert number is not None
    wrong = repr(float(number[1]) * (1 + 1e-8) + 1e-8)
    (tmp_path / "selftest_vectors.h").write_text(text[: number.start(1)] + wrong + text[number.end(1) :])
    shutil.copy(library / "selftest.c", tmp_path)
    run(gcc, "-std=c99", f"-I{library}", "selftest.c", library / "libgearmath.a", "-lm", "-o", "wrong", cwd=tmp_path)
    assert "deviates from the design programs" in run("./wrong", cwd=tmp_path, status=1)


def test_sanitizers_find_nothing(library: Path, gcc: str) -> None:
    flags = ("-std=c99", "-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    run(gcc, *flags, "selftest.c", *sorted(library.glob("gm_*.c")), "-o", "sanitized", "-lm", cwd=library)
    assert everything_agrees(run("./sanitized", cwd=library))


def test_valgrind_finds_nothing(library: Path) -> None:
    assert everything_agrees(run(tool("valgrind", "valgrind"), "-q", "--error-exitcode=9", "./selftest", cwd=library))


def test_static_library_for_64_bit_arm_passes_in_emulation(library: Path) -> None:
    compiler = tool("aarch64-linux-gnu-gcc", "gcc-aarch64-linux-gnu libc6-dev-arm64-cross")
    run("make", "-s", "aarch64", cwd=library)
    run(compiler, "-std=c99", "-static", "selftest.c", "-Laarch64", "-lgearmath", "-lm", "-o", "arm", cwd=library)
    assert everything_agrees(run(tool("qemu-aarch64", "qemu-user"), "./arm", cwd=library))


def test_dll_exports_our_functions_only_and_links_by_its_import_library(library: Path) -> None:
    compiler = tool("x86_64-w64-mingw32-gcc", "gcc-mingw-w64-x86-64")
    run("make", "-s", "dll", cwd=library)
    table = run("x86_64-w64-mingw32-objdump", "-p", "gearmath.dll", cwd=library)
    exported = re.findall(r"^\t\[ *\d+\] (\w+)$", table.split("[Ordinal/Name Pointer] Table")[1], flags=re.MULTILINE)
    assert set(exported) == public_names()
    run(compiler, "-std=c99", "selftest.c", "-o", "selftest.exe", "-L.", "-lgearmath", cwd=library)
    imports = run("x86_64-w64-mingw32-objdump", "-p", "selftest.exe", cwd=library)
    assert "DLL Name: gearmath.dll" in imports


def test_dll_and_gm_post_run_on_windows(library: Path, tmp_path: Path, vertical: MillingMachine) -> None:
    """The self-test on the DLL; and a program of polynomials, byte for byte, though sines come from another library."""
    compiler = tool("x86_64-w64-mingw32-gcc", "gcc-mingw-w64-x86-64")
    started = ("env", f"WINEPREFIX={tmp_path / 'wine'}", "WINEDEBUG=-all", wine())
    run("make", "-s", "dll", cwd=library)
    run(compiler, "-std=c99", "selftest.c", "-o", "selftest.exe", "-L.", "-lgearmath", cwd=library)
    assert everything_agrees(run(*started, "selftest.exe", cwd=library))
    plan = cutting_plan(load_pair(bundled("nasa_tp3096_12x36.toml")), "pinion", vertical, CuttingJob(blocks="poly"))
    (library / "pinion.settings").write_text(post_file(plan), "ascii")
    run(*started, "gm-post.exe", "pinion.settings", "-o", "CUT.MPF", cwd=library)
    assert (library / "CUT.MPF").read_bytes() == program_of(plan, "CUT").encode()


def wine() -> str:
    """What runs programs of Windows. CI does not install it: two hundred megabytes for one test."""
    found = next(filter(None, map(shutil.which, ("wine", "wine64", "/usr/lib/wine/wine64"))), None)
    if found is None:
        missing = pytest.xfail if os.environ.get("CI") == "true" else pytest.skip
        missing("needs wine (Debian: apt install wine64)")
    return str(found)


def public_names() -> set[str]:
    kernels = {f"gm_{kernel.name}{end}" for kernel in cnc_kernels() for end in ("", "_batch")}
    return kernels | {"gm_abi_version", "gm_version", "gm_error_text"}


def test_shared_library_exports_our_functions_only_under_its_soname(library: Path) -> None:
    with (library / "libgearmath.so").open("rb") as stream:
        elf = ELFFile(stream)
        symbols = elf.get_section_by_name(".dynsym").iter_symbols()
        exported = {s.name for s in symbols if s["st_shndx"] != "SHN_UNDEF" and s["st_info"]["bind"] != "STB_LOCAL"}
        (soname,) = (tag.soname for tag in elf.get_section_by_name(".dynamic").iter_tags("DT_SONAME"))
        writable = elf.get_section_by_name(".data"), elf.get_section_by_name(".bss")
    assert exported == public_names()
    assert soname == "libgearmath.so.1"
    # nothing is kept between calls: what is writable is what the compiler puts there itself
    assert all(section is None or section["sh_size"] <= 16 for section in writable)


def test_nothing_is_allocated_and_nothing_is_printed(library: Path) -> None:
    with (library / "libgearmath.so").open("rb") as stream:
        symbols = ELFFile(stream).get_section_by_name(".dynsym").iter_symbols()
        needed = {s.name for s in symbols if s["st_shndx"] == "SHN_UNDEF" and s["st_info"]["bind"] == "STB_GLOBAL"}
    assert needed <= {"sin", "cos", "tan", "atan2", "sqrt", "fmin", "fmax", "sincos", "asin", "acos", "atan", "pow"}


_P = ctypes.POINTER(ctypes.c_double)


def batch(library: ctypes.CDLL, name: str, n: int, inputs: list, sizes: list[int], outputs: list) -> tuple[int, int]:
    """Status and first bad point; an input is an array, or None for a null pointer."""
    function = getattr(library, f"gm_{name}_batch")
    function.argtypes = [
        ctypes.c_int64,
        *[_P, ctypes.c_int64] * len(inputs),
        *[_P] * len(outputs),
        ctypes.POINTER(ctypes.c_int64),
    ]
    bad = ctypes.c_int64(99)

    def pointer(array: np.ndarray | None) -> object:
        return None if array is None else array.ctypes.data_as(_P)

    kept = [None if array is None else np.ascontiguousarray(array) for array in inputs]
    given = [part for array, size in zip(kept, sizes, strict=True) for part in (pointer(array), size)]
    return function(n, *given, *map(pointer, outputs), bad), bad.value


_NUMBER = r"-?[\d.]+(?:e[+-]?\d+)?"


def promised(header: str) -> Iterator[tuple[str, int, float, float]]:
    """Input, element and the numbers that are taken, as the comment of a header has them."""
    name = ""
    # lines that the comment broke are joined again
    for line in re.sub(r"\n \*     (?!\[)\s*", " ", header).splitlines():
        if argument := re.match(r" \* in (\w+)", line):
            name = argument[1]
        elif not line.startswith(" *     ["):
            name = ""
        element = re.match(r" \*     \[(\d+)\]", line)
        ends = re.search(rf"taken: ({_NUMBER}) \.\.\. ({_NUMBER})\)", line) or re.search(
            rf"\] ({_NUMBER}) \.\.\. ({_NUMBER})", line
        )
        if name and ends:
            yield name, int(element[1]) if element else 0, float(ends[1]), float(ends[2])


def test_what_a_header_does_not_take_is_refused_point_by_point(
    library: Path, loaded: ctypes.CDLL, samples: Callable
) -> None:
    count = 0
    for kernel in cnc_kernels():
        drawn, names = samples(kernel.name, 4), [quantity.name for quantity in kernel.inputs]
        sizes = [quantity.size for quantity in kernel.inputs]
        for name, element, low, high in promised((library / f"gm_{kernel.name}.h").read_text()):
            beyond = 1e-6 * max(abs(low), abs(high))
            for value, refused in (
                (low - beyond, True),
                (high + beyond, True),
                (np.nan, True),
                (np.inf, True),
                (low, False),
                (high, False),
            ):
                inputs = [np.array(values, order="C") for values in drawn]
                inputs[names.index(name)].reshape(4, -1)[2, element] = value
                outputs = [np.zeros((4, quantity.size)) for quantity in kernel.outputs]
                status, bad = batch(loaded, kernel.name, 4, inputs, sizes, outputs)
                assert (status == 3) == refused, (kernel.name, name, element, value)
                assert bad == (-1 if status == 0 else 2)
                assert status == 0 or all(np.isnan(values[2]).all() for values in outputs)
                assert all(np.isfinite(values[[0, 1, 3]]).all() for values in outputs)
                count += 1
    assert count > 900


def test_a_flank_is_on_one_side_or_the_other(loaded: ctypes.CDLL, samples: Callable) -> None:
    u, beta, theta, settings, side = samples("flank_family", 4)
    for wrong in (0.0, 0.5, 2.0, np.nan):
        side[3] = wrong
        outputs = [np.zeros((4, 3)), np.zeros((4, 3))]
        given = [u, beta, theta, settings, side]
        assert batch(loaded, "flank_family", 4, given, [1, 1, 1, 12, 1], outputs) == (3, 3)


def test_what_a_header_requires_is_refused_at_a_singular_pose(loaded: ctypes.CDLL, samples: Callable) -> None:
    """Tilted by 0.4 rad towards a work axis that stands 0.4 rad from the cradle axis: both axes are one."""
    settings, theta, height, offset = samples("axis_transform", 3)
    settings[1, [1, 2, 3, 7]] = 0.0, 0.4, np.pi / 2, np.pi / 2 - 0.4
    theta[1] = 0.0
    axes = np.zeros((3, 5))
    assert batch(loaded, "axis_transform", 3, [settings, theta, height, offset], [12, 1, 1, 3], [axes]) == (4, 1)
    assert np.isnan(axes[1]).all()
    assert np.isfinite(axes[[0, 2]]).all()


def test_a_batch_along_a_roll_gives_the_bits_of_its_points(
    loaded: ctypes.CDLL, samples: Callable, same_bits: Callable
) -> None:
    """What only the settings decide is computed once there: the same operations, and the same refusals."""
    settings, theta, height, offset = samples("axis_transform", 300)
    for k in range(20):
        shared = [settings[k], theta, height[k : k + 1], offset[k]]
        along, alone = np.zeros((300, 5)), np.zeros((300, 5))
        repeated = [np.tile(settings[k], (300, 1)), theta, np.full(300, height[k]), np.tile(offset[k], (300, 1))]
        for bad in (None, 17):
            if bad is not None:
                theta[bad] = np.nan
            wanted = batch(loaded, "axis_transform", 300, repeated, [12, 1, 1, 3], [alone])
            assert batch(loaded, "axis_transform", 300, shared, [0, 1, 0, 0], [along]) == wanted
            assert same_bits(along, alone)
            assert bad is None or np.isnan(along[bad]).all()
        theta[17] = 0.0
    tilted = settings[0].copy()
    tilted[[1, 2, 3, 7]] = 0.0, 0.4, np.pi / 2, np.pi / 2 - 0.4  # singular where theta is zero
    rolled = [tilted, np.array([0.5, 0.4, 0.0, 0.3]), height[:1], offset[0]]
    axes = np.zeros((4, 5))
    assert batch(loaded, "axis_transform", 4, rolled, [0, 1, 0, 0], [axes]) == (4, 2)
    assert np.isnan(axes[2]).all()
    assert np.isfinite(axes[[0, 1, 3]]).all()


def test_sizes_strides_and_null_pointers_are_refused(loaded: ctypes.CDLL, samples: Callable) -> None:
    tip, radius, point, normal = samples("point_deviation", 3)
    inputs, sizes, out = [tip, radius, point, normal], [3, 1, 3, 3], np.zeros(3)
    assert batch(loaded, "point_deviation", -1, inputs, sizes, [out]) == (2, -1)
    assert batch(loaded, "point_deviation", 3, inputs, [3, -1, 3, 3], [out]) == (2, -1)
    assert batch(loaded, "point_deviation", 3, [tip, None, point, normal], sizes, [out]) == (1, -1)
    assert batch(loaded, "point_deviation", 3, inputs, sizes, [None]) == (1, -1)
    assert batch(loaded, "point_deviation", 0, [None] * 4, sizes, [None]) == (0, -1)
    assert batch(loaded, "point_deviation", 3, inputs, sizes, [out]) == (0, -1)
    assert loaded.gm_point_deviation(None, ctypes.c_double(1.0), None, None, None) == 1
    texts = {loaded.gm_error_text(status) for status in (0, 1, 2, 3, 4, 5, 77)}
    assert len(texts) == 7


def test_eight_threads_give_the_bits_of_one(loaded: ctypes.CDLL, samples: Callable, same_bits: Callable) -> None:
    kernels = [kernel for kernel in cnc_kernels() if kernel.name in ("flank_on_line", "axis_transform", "line_entry")]
    work = [(kernel, samples(kernel.name, 200)) for kernel in kernels]

    def run_all(found: list[np.ndarray]) -> None:
        for kernel, inputs in work:
            outputs = [np.zeros((200, quantity.size)) for quantity in kernel.outputs]
            batch(loaded, kernel.name, 200, list(inputs), [quantity.size for quantity in kernel.inputs], outputs)
            found += outputs

    alone: list[np.ndarray] = []
    run_all(alone)
    each: list[list[np.ndarray]] = [[] for _ in range(8)]
    threads = [threading.Thread(target=run_all, args=(found,)) for found in each]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(same_bits(one, other) for found in each for one, other in zip(found, alone, strict=True))


def test_c_consumer_links_by_pkg_config(library: Path, installed: Path, gcc: str, tmp_path: Path) -> None:
    tool("pkg-config", "pkg-config")
    config = (f"--define-variable=prefix={installed}", "--cflags", "--libs", "gearmath")
    path = installed / "lib" / "pkgconfig"
    flags = run("env", f"PKG_CONFIG_PATH={path}", "pkg-config", *config, cwd=tmp_path).split()
    run(gcc, "-std=c99", *STRICT, library / "examples/c/axes.c", *flags, "-lm", "-o", "axes", cwd=tmp_path)
    assert "node 4 refused" in run("env", f"LD_LIBRARY_PATH={installed / 'lib'}", "./axes", cwd=tmp_path)


def test_cpp_consumer_finds_the_settings_that_were_wrong(library: Path, installed: Path, tmp_path: Path) -> None:
    compiler = tool("g++", "g++")
    source, include = library / "examples/cpp/closed_loop.cpp", installed / "include" / "gearmath"
    flags = ("-std=c++17", *STRICT, f"-I{include}")
    run(compiler, *flags, source, installed / "lib" / "libgearmath.a", "-o", "loop", cwd=tmp_path)
    found = re.search(r"15 touches: settings found to (\S+)", run("./loop", cwd=tmp_path))
    assert found is not None
    assert float(found[1]) < 1e-9


def test_cmake_builds_tests_and_installs_and_a_project_finds_the_package(library: Path, tmp_path: Path) -> None:
    tool("cmake", "cmake")
    run("cmake", "-S", library, "-B", "build", f"-DCMAKE_INSTALL_PREFIX={tmp_path / 'to'}", cwd=tmp_path)
    run("cmake", "--build", "build", cwd=tmp_path)
    assert "100% tests passed" in run("ctest", "--test-dir", "build", cwd=tmp_path)
    run("cmake", "--install", "build", cwd=tmp_path)
    assert (tmp_path / "to/lib/libgearmath.so.1").exists()
    consumer = library / "examples" / "cmake"
    run("cmake", "-S", consumer, "-B", "user", f"-DCMAKE_PREFIX_PATH={tmp_path / 'to'}", cwd=tmp_path)
    run("cmake", "--build", "user", cwd=tmp_path)
    assert "node 4 refused" in run("user/axes", cwd=tmp_path)
    run("user/closed_loop", cwd=tmp_path)


def test_python_consumer_gives_what_the_c_consumer_gives(library: Path, installed: Path, tmp_path: Path) -> None:
    shared = installed / "lib" / "libgearmath.so.1"
    printed = run(sys.executable, library / "examples/ctypes/axes.py", shared, cwd=tmp_path)
    assert "theta +0.00 X -33.86865 Y -63.33699 Z 500.00000" in printed
    assert "node 4 refused" in printed


def test_linuxcnc_component_compiles_for_the_servo_thread(library: Path) -> None:
    """Its run in a servo thread belongs to the tests of LinuxCNC."""
    run(tool("halcompile", "linuxcnc-uspace-dev"), "--compile", "examples/linuxcnc/gm_axes.comp", cwd=library)
    with (library / "gm_axes.so").open("rb") as stream:
        names = {s.name: s["st_shndx"] for s in ELFFile(stream).get_section_by_name(".dynsym").iter_symbols()}
    assert names["rtapi_app_main"] != "SHN_UNDEF"
    assert not [name for name, place in names.items() if name.startswith("gm_") and place == "SHN_UNDEF"]


def test_headers_serve_cpp_17_and_refuse_flags_that_change_numbers(library: Path, gcc: str, tmp_path: Path) -> None:
    (tmp_path / "all.cpp").write_text('#include "gearmath.h"\nint main() { return gm_abi_version() - 1; }\n')
    run(tool("g++", "g++"), "-std=c++17", *STRICT, f"-I{library}", "-fsyntax-only", "all.cpp", cwd=tmp_path)
    for flag, words in (("-ffast-math", "ffast-math"), ("-fsingle-precision-constant", "gm_double_literals")):
        command = [gcc, "-std=c99", "-fsyntax-only", flag, "gm_tool_pose.c"]
        done = subprocess.run(command, cwd=library, capture_output=True, text=True)
        assert done.returncode != 0
        assert words in done.stderr
