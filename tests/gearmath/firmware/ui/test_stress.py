"""Anyone may do anything: no screen is undefined, nothing moves unasked, and no running ratio changes."""

from __future__ import annotations

import random

import pytest

POLL, UP, DOWN, SHORT, LONG = range(5)
IDLE, RUN, MOVE, FAULT = range(4)


def asked_to_run(rows: list[str], event: int) -> bool:
    """The operator has seen the question, turned to the answer, and pressed."""
    started = rows[3].startswith("Start?") and ">yes<" in rows[3]
    return event == SHORT and (started or any(row.startswith(">run on") for row in rows))


def asked_to_move(rows: list[str], event: int) -> bool:
    armed = rows[2].startswith("ARMED") and event in (UP, DOWN)
    turn = rows[3].startswith("Turn it?") and ">yes<" in rows[3]
    chosen = any(row.startswith((">back to start", ">next start")) for row in rows)
    return armed or (event == SHORT and (turn or rows[3].startswith("Press: go") or chosen))


@pytest.mark.parametrize("machine", ["hobbing_plewes", "hobbing_helical", "lathe_example"])
def test_100000_random_events_never_move_the_table_unasked(panel, machine):
    p, rng = panel(machine), random.Random(20)
    rows, seen, runs, moves = p.screen.split("\n"), set(), 0, 0
    for _ in range(100_000 if machine == "hobbing_plewes" else 30_000):
        before, job, position = p.mode, p.job, p.position
        event = rng.choices((POLL, UP, DOWN, SHORT, LONG), (2, 4, 3, 4, 0.6))[0]
        requests = p.event(event, after_ms=rng.choice((5, 50, 200)))
        after = p.mode
        if after == RUN and before != RUN:
            assert before == IDLE
            assert asked_to_run(rows, event), rows
            runs += 1
        if after == MOVE and before != MOVE:
            assert before == IDLE
            assert asked_to_move(rows, event), rows
            moves += 1
        if before == RUN:
            assert p.job == job
            assert requests == 0
        assert p.position in (position, 0)  # nothing but the interrupts makes steps; a job starts at 0
        rows = p.screen.split("\n")  # which checks that they are 4 x 20 printable characters
        assert not any("#" in row for row in rows), rows
        seen.add(rows[0][:5])
        if rng.random() < 0.3:
            p.library.board_ticks(rng.choice((10, 1000, 20_000)))
        if rng.random() < 0.1:
            p.library.board_edges(0, rng.randrange(30), rng.choice((-1, 1)), 20)
        if rng.random() < 0.002:
            p.library.board_estop(1)
            p.library.board_ticks(20)
            p.library.board_estop(0)
            p.library.board_ticks(20)
        if rng.random() < 0.3:
            p.event(POLL, after_ms=1)
            rows = p.screen.split("\n")
    assert runs > 30
    assert moves > 30
    assert len(seen) > 12, seen
