"""Nanoseconds an edge: the generated step rules, hand-written C, and the float rule of the public firmware.

The hand-written rules and the float rule are typed here on purpose, as the witness; every one is called through a
function of the same kind, from a loop of the same kind, in a file of its own.
"""

from __future__ import annotations

import ctypes
import timeit

import numpy as np
import pytest

from derivations.gearbox import gearbox_edge, gearbox_step
from gearmath.engine.compiler import compile_library
from gearmath.export.c import integer_kernel
from gearmath.lowering import lower

N_EDGES = 2_000_000
NUMERATOR, DENOMINATOR = 125, 192  # the densest steps of the source text, 6 teeth
LOOP = """\
INCLUDE
static volatile REAL ratio[2] = {NUMERATOR, DENOMINATOR}; /* not known to the compiler */

long run(long n, const signed char *edges)
{
  const REAL N = ratio[0], D = ratio[1];
  REAL remainder = (REAL)DENOMINATOR / 2;
  long k, position = 0;
  (void)remainder;
  for (k = 0; k < n; ++k) {
    REAL step = 0, d = (REAL)edges[k];
    CALL
    position += (long)step;
  }
  return position;
}
"""
HAND = """\
#include <stdint.h>
static inline REAL hand(REAL *remainder, REAL d, REAL N, REAL D)
{
  *remainder += d > 0 ? N : -N;
  if (*remainder >= D) { *remainder -= D; return 1; }
  if (*remainder < 0) { *remainder += D; return -1; }
  return 0;
}
"""
FLOAT = """\
#include <math.h>
static float count, delivered;
"""
FLOAT_CALL = """\
    count += 1;
    if (roundf(N / D * count) > delivered) { delivered += 1; step = d; }
"""
STEP_CALL = "gm_gearbox_step(remainder, d, N, D, &step, &remainder);"
EDGE_CALL = "gm_gearbox_edge(remainder, d, N, 0, D, &step, &remainder);"
HAND_CALL = "step = hand(&remainder, d, N, D);"


def library(kind: str) -> ctypes.CDLL:
    """One rule and its loop."""
    real = "int64_t" if "int64" in kind else "float" if kind == "float rule" else "int32_t"
    name = kind.split()[0]
    kernels = {"gearbox_step": (gearbox_step, STEP_CALL), "gearbox_edge": (gearbox_edge, EDGE_CALL)}
    files: dict[str, str] = {}
    if name in kernels:
        expression, call = kernels[name]
        files = integer_kernel(lower(expression()), 64 if real == "int64_t" else 32, inline=True).files
        include = f'#include "gm_{name}.h"'
    else:
        include, call = (HAND, HAND_CALL) if name == "hand" else (FLOAT, FLOAT_CALL)
    text = LOOP.replace("INCLUDE", include).replace("CALL", call).replace("REAL", real)
    text = text.replace("NUMERATOR", str(NUMERATOR)).replace("DENOMINATOR", str(DENOMINATOR))
    return compile_library(files | {"loop.c": text})


KINDS = ("gearbox_step int32", "gearbox_edge int32", "gearbox_edge int64", "hand int32", "hand int64", "float rule")


@pytest.mark.benchmark(group="electronic gearbox")
def test_edges_per_second_generated_by_hand_and_in_float(benchmark, host_compiler) -> None:
    edges = np.where(np.random.default_rng(1).random(N_EDGES) < 0.9, 1, -1).astype(np.int8)
    arguments = ctypes.c_long(N_EDGES), ctypes.c_void_p(edges.ctypes.data)
    nanoseconds, positions = {}, {}
    for kind in KINDS:
        run = library(kind).run
        run.restype = ctypes.c_long
        positions[kind] = run(*arguments)
        nanoseconds[kind] = min(timeit.repeat(lambda run=run: run(*arguments), number=1, repeat=5)) * 1e9 / N_EDGES
    exact = (2 * NUMERATOR * int(edges.sum(dtype=int)) + DENOMINATOR) // (2 * DENOMINATOR)
    assert {positions[kind] for kind in KINDS[:5]} == {exact}
    benchmark(library("gearbox_step int32").run, *arguments)
    benchmark.extra_info.update({kind: round(value, 2) for kind, value in nanoseconds.items()})
    by_hand = nanoseconds["hand int32"]
    print("\nns an edge:", ", ".join(f"{kind} {value:.2f}" for kind, value in nanoseconds.items()))
    ratio = " : ".join(f"{nanoseconds[k] / by_hand:.2f}" for k in ("gearbox_step int32", "hand int32", "float rule"))
    print(f"generated : hand-written : float rule = {ratio}")
