"""Compiled kernels on this computer: the same bits as the CasADi function, the same shapes, exact integers."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from derivations import gearbox
from derivations.expression import Quantity
from gearmath.engine import compiler
from gearmath.engine.compiler import compile_library
from gearmath.engine.kernel import Kernel
from gearmath.errors import ComputationError, InputError
from gearmath.export import host
from gearmath.export.c import contract_files, double_kernel, integer_kernel
from gearmath.export.cnc import cnc_kernels
from gearmath.export.host import compile_kernel, run_edges
from gearmath.lowering import lower

DOUBLE = {kernel.name: kernel for kernel in cnc_kernels()}

pytestmark = pytest.mark.usefixtures("host_compiler")


@pytest.mark.parametrize("name", DOUBLE)
def test_c_equals_casadi_bit_for_bit(name: str, samples: Callable, same_bits: Callable) -> None:
    arguments = samples(name, 1000)
    for ours, casadis in zip(compile_kernel(DOUBLE[name])(*arguments), DOUBLE[name](*arguments), strict=True):
        assert same_bits(ours, casadis)
        assert np.isfinite(ours).all()


def test_shared_arguments_are_broadcast_like_those_of_the_kernel(samples: Callable, same_bits: Callable) -> None:
    kernel = DOUBLE["flank_family"]
    u, beta, theta, settings_, side = samples("flank_family", 7)
    compiled = compile_kernel(kernel)
    for arguments in (
        (u, beta, theta, settings_, side),
        (u, beta, theta, settings_[0], side[0]),
        (u[0], beta[0], theta[0], settings_[0], 1),
        (u[:0], beta[:0], theta[:0], settings_[0], 1),
        (u[::2], beta[::2], theta[::2], np.asfortranarray(settings_)[::2], -1),
    ):
        for ours, casadis in zip(compiled(*arguments), kernel(*arguments), strict=True):
            assert same_bits(np.ascontiguousarray(ours), np.ascontiguousarray(casadis))


def test_wrong_number_and_wrong_shape_of_arguments_are_refused() -> None:
    compiled = compile_kernel(DOUBLE["tool_pose"])
    with pytest.raises(TypeError, match="tool_pose: the arguments are axes, pivot_height, pivot_offset; 1 given"):
        compiled(np.zeros(5))
    with pytest.raises(ValueError, match=r"axes has shape \(4,\), expected \(5,\)"):
        compiled(np.zeros(4), 0.0, np.zeros(3))
    with pytest.raises(ValueError, match="pivot_height has shape"):
        compiled(np.zeros((3, 5)), np.zeros(2), np.zeros(3))


def test_point_outside_the_domain_is_refused_by_its_number() -> None:
    compiled = compile_kernel(DOUBLE["tool_pose"])
    axes = np.zeros((3, 5))
    axes[2, 1] = np.nan
    with pytest.raises(InputError, match="tool_pose at point 2: an input is not a number, or outside the range"):
        compiled(axes, 0.0, np.zeros(3))


def _quantity(name: str, *shape: int) -> Quantity:
    return Quantity(name, "a test", "1", name, (-100.0, 100.0), shape=shape)


def test_matrices_go_in_and_out_row_by_row() -> None:
    M, v = ca.SX.sym("M", 2, 3), ca.SX.sym("v", 3)
    function = ca.Function(
        "turned", [M, v], [M @ v, M.T, ca.blockcat([[v[0], 0], [0, v[1]]])], ["M", "v"], ["p", "T", "S"]
    )
    kernel = Kernel(
        function,
        "A test.",
        (_quantity("M", 2, 3), _quantity("v", 3)),
        (_quantity("p", 2), _quantity("T", 3, 2), _quantity("S", 2, 2)),
    )
    matrices, vector = np.random.default_rng(2).normal(size=(4, 2, 3)), np.array([1.0, 10.0, 100.0])
    product, transposed, sparse = compile_kernel(kernel)(matrices, vector)
    np.testing.assert_allclose(product, matrices @ vector, rtol=1e-14)
    np.testing.assert_array_equal(transposed, matrices.transpose(0, 2, 1))
    np.testing.assert_array_equal(sparse, np.broadcast_to(np.diag([1.0, 10.0]), (4, 2, 2)))


def test_composed_kernel_gets_its_work_memory(same_bits: Callable) -> None:
    x, a = ca.SX.sym("x"), ca.SX.sym("a", 2)
    newton = ca.Function("newton", [x, a], [x - (x**2 - a[0] * a[1]) / (x + x)])
    start, given_ = ca.MX.sym("start"), ca.MX.sym("given", 2)
    root = newton.fold(8)(start, ca.repmat(given_, 1, 8))
    function = ca.Function("root", [start, given_], [root, root * given_], ["start", "given"], ["root", "scaled"])
    kernel = Kernel(
        function, "A test.", (_quantity("start"), _quantity("given", 2)), (_quantity("root"), _quantity("scaled", 2))
    )
    factors = np.random.default_rng(3).uniform(0.5, 2.0, (50, 2))
    root, scaled = compile_kernel(kernel)(1.0, factors)
    np.testing.assert_allclose(root, np.sqrt(factors.prod(axis=1)), rtol=1e-14)
    np.testing.assert_array_equal(scaled, root[:, None] * factors)
    assert all(same_bits(ours, casadis) for ours, casadis in zip((root, scaled), kernel(1.0, factors), strict=True))


@settings(max_examples=50)
@given(st.data())
def test_delivered_steps_are_the_nearest_to_the_exact_position(data: st.DataObject) -> None:
    """Python's own integers: p = floor((2Ne + D)/(2D)), and an error of at most half a step."""
    D = data.draw(st.integers(1, 2**30), "D")
    N = data.draw(st.integers(1, D), "N")
    edges = np.array(data.draw(st.lists(st.sampled_from((-1, 1)), max_size=200), "edges"), dtype=np.int8)
    steps, remainder = run_edges(edges, N, D, D // 2)
    e = p = 0
    for edge, step in zip(edges.tolist(), steps.tolist(), strict=True):
        e, p = e + edge, p + step
        assert p == (2 * N * e + D) // (2 * D)
    assert remainder == D // 2 + N * e - p * D


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([0], 1, 2, 0), "edges"),
        (([1], 3, 2, 0), "N <= D"),
        (([1], 1, 2**30 + 1, 0), "2\\^30"),
        (([1], 1, 2, 2), "remainder = 2"),
    ],
)
def test_step_rule_refuses_what_lies_outside_its_domain(arguments: tuple, message: str) -> None:
    with pytest.raises(InputError, match=message):
        run_edges(*arguments)


def test_integer_kernel_of_64_bits_computes_beyond_32() -> None:
    library = compile_library(integer_kernel(lower(gearbox.gearbox_terms()), bits=64).files)
    N, D = ctypes.c_int64(), ctypes.c_int64()
    arguments = (ctypes.c_int64(value) for value in (999, 7, 4_000_000, 2**40))
    library.gm_gearbox_terms(*arguments, ctypes.byref(N), ctypes.byref(D))
    assert (N.value, D.value) == (7 * 2**40, 999 * 4_000_000)


def test_compiler_error_is_one_sentence() -> None:
    with pytest.raises(ComputationError, match=r"^the C compiler .* failed: .*error"):
        compile_library({"broken.c": "int x = ;\n"})


def test_ziglang_serves_where_no_compiler_is_installed_and_says_so(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture
) -> None:
    monkeypatch.setattr(compiler.shutil, "which", lambda name: None)
    assert compiler.find_compiler.__wrapped__() == (sys.executable, "-m", "ziglang", "cc")
    assert "ziglang" in capfd.readouterr().err
    monkeypatch.setattr(compiler.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ComputationError, match="install gcc"):
        compiler.find_compiler.__wrapped__()


@pytest.mark.slow
def test_c_compiled_by_zig_equals_casadi_too(
    monkeypatch: pytest.MonkeyPatch, samples: Callable, same_bits: Callable
) -> None:
    monkeypatch.setattr(compiler, "find_compiler", lambda: (sys.executable, "-m", "ziglang", "cc"))
    kernel = DOUBLE["axis_transform"]
    library = compile_library(contract_files() | double_kernel(kernel).files)
    arguments = samples("axis_transform", 1000)
    (ours,), (casadis,) = host.CompiledKernel(kernel, library)(*arguments), kernel(*arguments)
    assert same_bits(ours, casadis)
