"""The core compiled for a Cortex-M4 and run there: no wrong step, and what an edge costs in instructions.

Counted are executed instructions, per basic block, from the first of the function to its return.
"""

import struct

import numpy as np
import pytest

from gearmath.specs.board import BOARDS

DATA = 0x2000_0000
NEXT_STEP, NEXT_REMAINDER = DATA, DATA + 8
M4 = {"GM_STEP_HIGH_TICKS": 1, "GM_STEP_LOW_TICKS": 1, "GM_DIR_SETUP_TICKS": 1, "GM_DIR_HOLD_TICKS": 1}
SLOW_ENOUGH = {"GM_MAX_EDGE_RATE": 1_000_000}  # the emulated edges come every few ticks


def words(value: int) -> tuple[int, int]:
    """A 64-bit number as two words."""
    return value & 0xFFFFFFFF, (value >> 32) & 0xFFFFFFFF


def set_job(target, wide: bool, N: int, D: int, feed: int = 0, hysteresis: int = 0) -> None:
    """Write gm_job as the target lays it out, and start."""
    (q, rest), (feed_q, feed_rest) = divmod(N, D), divmod(feed, D)
    wide_letter = "q" if wide else "i"
    job = struct.pack(f"<3{wide_letter}3i", D, rest, feed_rest, q, feed_q, hysteresis)
    target.write(target.symbols["job"], job)
    target.call("start")


def drive(target, edges: np.ndarray, ticks: int) -> np.ndarray:
    """position + pending after every edge."""
    n = len(edges)
    target.write(DATA, edges.astype(np.int8).tobytes())
    target.call("drive", DATA, DATA + 0x40_0000, n, ticks)
    return np.frombuffer(target.read(DATA + 0x40_0000, 4 * n), np.int32)


def nearest(N: int, feed: int, D: int, edges: np.ndarray) -> np.ndarray:
    """floor((2 (N e + N_f e_f) + D)/(2 D)) in the whole numbers of Python."""
    hob = np.cumsum(np.where(edges % 2, edges, 0), dtype=np.int64).tolist()
    other = np.cumsum(np.where(edges % 2, 0, edges // 2), dtype=np.int64).tolist()
    return np.array([(2 * (N * e + feed * f) + D) // (2 * D) for e, f in zip(hob, other, strict=True)])


@pytest.mark.slow
def test_million_edges_through_the_whole_core_give_no_wrong_step(core_on_target):
    """700 000 of the 32-bit core and 300 000 of the 64-bit core, two axes, ratios below and above one."""
    random = np.random.default_rng(7)
    cases = [
        (False, 125, 192, 0, 350_000),
        (False, -1000, 384, 5, 350_000),
        (True, 2**61 - 1, 2**62 - 57, -(2**55), 300_000),
    ]
    for wide, N, D, feed, n in cases:
        target = core_on_target(wide, **M4, **SLOW_ENOUGH)
        set_job(target, wide, N, D, feed)
        edges = random.choice([1, 1, 1, -1] if feed == 0 else [1, 1, 1, -1, 2, -2], n).astype(np.int8)
        assert np.count_nonzero(drive(target, edges, 8) != nearest(N, feed, D, edges)) == 0


def cost_of_kernel(target, name: str, wide: bool) -> int:
    """The dearest of all ways through one call."""
    costs = set()
    for remainder in (0, 1, 191):
        for edge in (1, -1):
            numbers = [remainder, edge, 125, 192] if name == "gearbox_step" else [remainder, edge, 125, 1, 192]
            arguments = [word for value in numbers for word in words(value)] if wide else numbers
            costs.add(target.instructions(f"gm_{name}", *arguments, NEXT_STEP, NEXT_REMAINDER))
            steps, following = struct.unpack("<qq" if wide else "<i4xi4x", target.read(DATA, 16))
            s, rest = divmod(remainder + edge * 125, 192)
            assert (steps, following) == (s + (0 if name == "gearbox_step" else edge), rest)
    return max(costs)


@pytest.mark.parametrize(
    ("name", "bits", "limit"), [("gearbox_step", 32, 16), ("gearbox_edge", 32, 24), ("gearbox_edge", 64, 50)]
)
def test_generated_kernel_keeps_its_budget_of_instructions(kernel_on_target, name, bits, limit):
    cost = cost_of_kernel(kernel_on_target(name, bits), name, bits == 64)
    print(f"{name} int{bits}: {cost} instructions")
    assert cost <= limit


@pytest.mark.parametrize("wide", [False, True])
def test_interrupts_keep_their_budget_of_instructions(core_on_target, wide):
    """The portable part of an edge <= 105 while the table follows, whatever the edge brings; the levels, which must not
    be late, are out after 90; the whole tick takes at most 250 instructions of its 360 cycles on a Teensy 3.2."""
    target = core_on_target(wide, **M4, **SLOW_ENOUGH, GM_HAS_INDEX=1, GM_ACCELERATION=80_000)
    core, edge_costs, levels_costs, tick_costs, index_costs = target.symbols["core"], [], [], [], []
    for N, D in ((125, 192), (1, 1), (1300, 384)):
        set_job(target, wide, N, D, feed=77)
        previous = 0
        for edge in (1, 1, 1, -1, -1, 1, -1, -1, -1, -1, 1, 1):
            for axis in (0, 1):
                edge_costs.append(target.instructions("gm_core_edge", core, axis, edge))
                for _ in range(45):  # through steering and, in all, some milliseconds
                    levels_costs.append(target.instructions("gm_core_outputs", core, 1))
                    tick_costs.append(levels_costs[-1] + target.instructions("gm_core_think", core))
                if edge != previous:  # then the hob stood for longer than steps are ever spread over
                    target.call("wait", 4001)
                previous = edge
        for count in (1, 1, 4096, 4096, -4096):  # a turn, and back
            for _ in range(abs(count)):
                target.call("gm_core_edge", core, 0, 1 if count > 0 else -1)
            target.call("wait", 2)
            index_costs.append(target.instructions("gm_core_index", core))
        for _ in range(620):  # until the last pulse is judged, 2 ms after it
            levels_costs.append(target.instructions("gm_core_outputs", core, 1))
            tick_costs.append(levels_costs[-1] + target.instructions("gm_core_think", core))
    costs = (max(edge_costs), max(levels_costs), max(tick_costs), max(index_costs))
    print(f"{'64' if wide else '32'} bits: edge, levels, whole tick, index at most {costs} instructions")
    assert max(edge_costs) <= 105
    assert max(levels_costs) <= 90
    assert max(tick_costs) <= 250
    assert max(index_costs) <= 120
    # what a tick may be late for one of them: 1.4 cycles an instruction with the flash's wait states, 12 to enter
    cycles = 1.4 * max(*edge_costs, *index_costs) + 12
    assert cycles / 72e6 <= BOARDS["teensy32"].jitter_ns * 1e-9
    assert cycles / 600e6 <= BOARDS["teensy41"].jitter_ns * 1e-9
