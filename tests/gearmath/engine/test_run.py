"""The decision how a function runs changes its time, and not one bit of its results."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from gearmath.engine import cache, compiler, run
from gearmath.kernels import kernel


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.setenv("GEARMATH_CACHE", str(tmp_path))
    cache.folder.cache_clear()
    yield tmp_path
    cache.folder.cache_clear()


def rolling() -> ca.Function:
    """Of a point (3,) and a matrix (2,3) that all points share, a vector and a matrix."""
    x, A = ca.SX.sym("x", 3), ca.SX.sym("A", 2, 3)
    return ca.Function("rolling", [x, A], [A @ ca.sin(x), ca.atan2(A, ca.repmat(x.T, 2, 1))])


def given(n: int) -> list[np.ndarray]:
    rng = np.random.default_rng(1)
    return [rng.standard_normal((n, 3)), rng.standard_normal((1, 6))]


def test_compiled_kept_and_interpreted_give_the_same_bits(place: Path, host_compiler, monkeypatch) -> None:
    monkeypatch.setattr(run, "_ASK", 0.0)
    first = run.KernelRunner(rolling(), (True, False))
    interpreted = first(given(1001), 1001)
    assert first._compiled is None
    assert not list(place.glob("kernel-*"))
    monkeypatch.setattr(run, "_COMPILE", 0.0)
    compiled = first(given(1001), 1001)
    assert first._compiled is not None
    assert len(list(place.glob("kernel-*"))) == 1
    monkeypatch.setattr(run, "_COMPILE", np.inf)
    second = run.KernelRunner(rolling(), (True, False))
    kept = second(given(1001), 1001)
    assert second._compiled is not None
    for one, two, three in zip(interpreted, compiled, kept, strict=True):
        np.testing.assert_array_equal(one, two)
        np.testing.assert_array_equal(one, three)
    np.testing.assert_allclose(
        compiled[0][7], given(1001)[1].reshape(2, 3, order="F") @ np.sin(given(1001)[0][7]), atol=1e-15
    )


@pytest.mark.parametrize("threads", [1, 2, 3, 7])
def test_results_do_not_depend_on_the_number_of_threads(threads, place, host_compiler, monkeypatch) -> None:
    monkeypatch.setattr(run, "_ASK", 0.0)
    monkeypatch.setattr(run, "_COMPILE", 0.0)
    monkeypatch.setattr(run, "_SPREAD", 1.0)
    one = run.KernelRunner(rolling(), (True, False))
    expected = one(given(1001), 1001)
    monkeypatch.setattr(run, "_threads", lambda: threads)
    for got, wanted in zip(one(given(1001), 1001), expected, strict=True):
        np.testing.assert_array_equal(got, wanted)


def test_a_damaged_library_is_compiled_anew(place: Path, host_compiler, monkeypatch) -> None:
    monkeypatch.setattr(run, "_ASK", 0.0)
    monkeypatch.setattr(run, "_COMPILE", 0.0)
    run.KernelRunner(rolling(), (True, False))(given(9), 9)
    (library,) = place.glob("kernel-*")
    library.write_bytes(library.read_bytes()[:-100])
    again = run.KernelRunner(rolling(), (True, False))
    again(given(9), 9)
    assert again._compiled is not None
    assert cache.read(library.name) is not None


@pytest.mark.skipif(os.name != "posix", reason="elsewhere a library that is open cannot be removed")
def test_a_process_that_is_killed_leaves_no_library_behind(tmp_path: Path, host_compiler) -> None:
    program = (
        "import os, signal, casadi as ca, numpy as np\n"
        "from gearmath.engine import run\n"
        "run._ASK = run._COMPILE = 0.0\n"
        "x = ca.SX.sym('x')\n"
        "for many in ((True,), (True,)):\n"  # the first compiles, the second loads what was kept
        "    runner = run.KernelRunner(ca.Function('f', [x], [ca.sin(x)]), many)\n"
        "    runner([np.ones((9, 1))], 9)\n"
        "    assert runner._compiled is not None\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    left, cached = tmp_path / "left", tmp_path / "cached"
    left.mkdir()
    environment = os.environ | {"TMPDIR": str(left), "GEARMATH_CACHE": str(cached)}
    assert subprocess.run([sys.executable, "-c", program], env=environment).returncode == -9
    assert len(list(cached.glob("kernel-*"))) == 1
    assert not list(left.iterdir())


def test_without_a_compiler_it_is_said_once_and_the_virtual_machine_runs(place, monkeypatch, capsys) -> None:
    monkeypatch.setattr(compiler.shutil, "which", lambda _: None)
    monkeypatch.setattr(compiler.importlib.util, "find_spec", lambda _: None)
    monkeypatch.setattr(run, "_ASK", 0.0)
    compiler.find_compiler.cache_clear()
    run._can_compile.cache_clear()
    try:
        for _ in range(2):
            (value, _) = run.KernelRunner(rolling(), (True, False))(given(5), 5)
        assert value.shape == (5, 2)
        assert capsys.readouterr().err.count("no C compiler was found") == 1
    finally:
        compiler.find_compiler.cache_clear()
        run._can_compile.cache_clear()


@pytest.mark.skipif(os.name != "posix", reason="the compilers of this test are shell scripts")
@pytest.mark.parametrize(
    ("script", "said"),
    [
        ("#!/bin/sh\nexit 1\n", "failed: no message"),
        ("#!/bin/sh\nprintf 'error \\377' >&2\nexit 1\n", "failed: error"),
        ("#!/bin/sh\nexit 0\n", "wrote no library"),
        ("#!/bin/sh\necho rubbish > libkernels.so\necho rubbish > libkernels.dylib\n", "cannot be loaded"),
        ("no program", "cannot be run"),
    ],
)
def test_a_compiler_that_fails_is_named_once_and_nothing_of_it_is_kept(
    script: str, said: str, place: Path, tmp_path_factory, monkeypatch, capsys
) -> None:
    folder, left = tmp_path_factory.mktemp("bad"), tmp_path_factory.mktemp("left")
    (folder / "cc").write_text(script)
    (folder / "cc").chmod(0o755)
    monkeypatch.setattr(run.tempfile, "tempdir", str(left))
    for module in (run, compiler):
        monkeypatch.setattr(module, "find_compiler", lambda: (str(folder / "cc"),))
    monkeypatch.setattr(run, "identity", lambda: script)
    monkeypatch.setattr(run, "_ASK", 0.0)
    monkeypatch.setattr(run, "_COMPILE", 0.0)
    run._say_slower.cache_clear()
    expected = run.KernelRunner(rolling(), (True, False)).interpreted(given(5), 5)
    for _ in range(2):
        for got, wanted in zip(run.KernelRunner(rolling(), (True, False))(given(5), 5), expected, strict=True):
            np.testing.assert_array_equal(got, wanted)
    err = capsys.readouterr().err
    assert (err.count("gearmath: "), err.count(said)) == (1, 1)
    assert not list(place.glob("kernel-*"))
    assert not list(left.iterdir())


@pytest.mark.parametrize("chosen", ["0", "-1", "abc", "²", "1.5", "99999999999999999999"])
def test_a_number_of_threads_that_is_none_is_said(chosen: str, monkeypatch, capsys) -> None:
    monkeypatch.setenv("GEARMATH_THREADS", chosen)
    assert run._threads.__wrapped__() == len(os.sched_getaffinity(0))
    assert f"GEARMATH_THREADS = {chosen!r}: must be a whole number from 1" in capsys.readouterr().err


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_forked_process_has_threads_of_its_own() -> None:
    """Those of its parent are not there any more: it would wait for them for ever."""
    program = (
        "import os\nfrom gearmath.engine import run\n"
        "run._pool().submit(int).result()\n"
        "if child := os.fork():\n"
        "    os._exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))\n"
        "run._pool().submit(int).result(timeout=20)\n"
        "os._exit(0)\n"
    )
    assert subprocess.run([sys.executable, "-W", "ignore", "-c", program]).returncode == 0


def test_a_process_with_kept_kernels_loads_no_sympy(place: Path) -> None:
    program = (
        "import sys\nfrom gearmath.kernels import kernel\n"
        "print(kernel('axis_transform').name, 'sympy' in sys.modules, len(kernel('axis_transform').inputs))"
    )
    said = [
        subprocess.run(
            [sys.executable, "-c", program], env=os.environ, capture_output=True, text=True, check=True
        ).stdout
        for _ in range(2)
    ]
    assert said[0].split()[1] == "True"
    assert said[1].split()[1] == "False"
    assert said[0].split()[::2] == said[1].split()[::2]


def test_kernel_of_no_points_gives_no_points_and_of_one_what_the_map_gives() -> None:
    """One point goes to the virtual machine without a map and without conversion: the same bits."""
    function = rolling()
    one = run.KernelRunner(function, (True, False))(given(1), 1)
    mapped = function.map(1)(given(1)[0].T, given(1)[1].reshape(2, 3, order="F"))
    for ours, theirs in zip(one, mapped, strict=True):
        np.testing.assert_array_equal(ours[0], np.asarray(theirs).ravel(order="F"))
    nothing = kernel("flank_turning")(np.zeros(0), np.zeros((0, 3)), np.zeros((0, 3)))
    assert [each.shape[0] for each in nothing] == [0, 0]
