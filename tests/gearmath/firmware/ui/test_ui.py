"""What the operator sees and does, as scripts of knob and button against screens written by hand."""

from __future__ import annotations

from fractions import Fraction

import pytest

from gearmath.export.screens import FAULT_MATRIX

IDLE, RUN, MOVE, FAULT = range(4)
SAVE = 1


def shows(panel, *rows: str) -> None:
    """The screen is these four rows; blanks at the right are left out here and must be there."""
    assert len(rows) == 4
    assert panel.screen.split("\n") == [row.ljust(20) for row in rows]


def start(panel, *pages: int) -> None:
    """From power-up through the pages of the job, turning the knob so far on each, to a confirmed start."""
    panel.short()
    for detents in pages:
        panel.knob(detents)
        panel.short()
    panel.knob(1)
    assert panel.short() == SAVE
    assert panel.mode == RUN


def stop(panel) -> None:
    panel.short()
    panel.knob(1)
    panel.short()
    panel.ticks(2000)
    assert panel.mode == IDLE


def test_teeth_then_hob_then_run(panel):
    p = panel("hobbing_plewes")
    shows(p, "No stored job", " 24 teeth      32 DP", "PHASE IS LOST", "Press: check the job")
    p.short()
    shows(p, "Teeth             24", "Steps            125", "Edges            768", "Press: next")
    p.knob(8)
    shows(p, "Teeth             32", "Steps            125", "Edges           1024", "Press: next")
    p.short()
    shows(p, "Hob      32 DP no  1", "Blank      1.0625 in", "Depth      0.0703 in", "2.25/P")
    p.knob(4)
    shows(p, "Hob    60.8 DP no  5", "Blank      0.5592 in", "Depth      0.0370 in", "2.25/P")
    p.knob(9)
    shows(p, "Hob       1 m  no 10", "Blank      34.000 mm", "Depth       2.250 mm", "2.25m")
    p.short()
    shows(p, "Hob starts, right  1", "Steps            125", "Edges           1024", "Press: next")
    p.short()
    shows(p, "Helix none, spur", "", "Blank      34.000 mm", "Press: next")
    p.short()
    shows(p, " 32 teeth       1 m", "Hob max      800 rpm", "PHASE STARTS HERE", "Start?   >no<  yes")
    assert p.mode == IDLE
    p.knob(1)
    shows(p, " 32 teeth       1 m", "Hob max      800 rpm", "PHASE STARTS HERE", "Start?    no  >yes<")
    assert p.short() == SAVE
    shows(p, " 32 teeth       1 m", "Hob          0.0 rpm", "Table       0.00 rpm", "In phase: lag      0")
    assert (p.mode, p.job) == (RUN, (1024, 125, 0, 0, 0))


def test_answering_no_starts_nothing_and_saves_nothing(panel):
    p = panel("hobbing_plewes")
    for _ in range(5):
        p.short()
    shows(p, " 24 teeth      32 DP", "Hob max      800 rpm", "PHASE STARTS HERE", "Start?   >no<  yes")
    assert p.short() == 0
    assert p.mode == IDLE
    shows(p, "Teeth             24", "Steps            125", "Edges            768", "Press: next")


def test_the_run_shows_speed_place_and_steps(panel):
    p = panel("hobbing_plewes")
    start(p, 26, 0, 0, 0)  # 50 teeth
    p.edges(20 * 4096, ticks=10)  # 20 turns in 4.096 s: 20000 edges/s
    shows(p, " 50 teeth      32 DP", "Hob        293.0 rpm", "Table       5.86 rpm", "In phase: lag      0")
    p.knob(1)
    shows(p, " 50 teeth      32 DP", "Hob turns      20.00", "Table     144.00 deg", "Tooth             21")
    p.knob(1)
    shows(p, " 50 teeth      32 DP", "No index pulse", "Steps           6400", "Table turns     0.40")
    assert p.position == 6400


def test_a_fast_knob_reaches_999_teeth_and_a_slow_one_every_count(panel):
    p = panel("hobbing_plewes")
    p.short()
    p.knob(-40, after_ms=20)
    assert p.edit.teeth == 1
    p.knob(1)
    assert p.edit.teeth == 2
    p.knob(1, after_ms=50)
    assert p.edit.teeth == 7
    p.knob(41, after_ms=20)
    assert p.edit.teeth == 999
    p.knob(-1, after_ms=10)  # the first detent back is a slow one
    assert p.edit.teeth == 998


def test_no_press_or_turn_while_running_changes_the_ratio(panel):
    p = panel("hobbing_plewes")
    start(p, 8, 0, 0, 0)
    job = p.job
    for _ in range(20):
        p.short()
        shows(p, "RUNS         0.0 rpm", "Clear the hob of the", "gear before you stop", "Stop?    >no<  yes")
        p.short()
        p.long()
        p.long()
        p.knob(3)
        p.knob(-3)
        p.edges(50)
        assert (p.mode, p.job) == (RUN, job)


def test_stop_must_be_confirmed_and_keeps_the_phase(panel):
    p = panel("hobbing_plewes")
    start(p, 8, 0, 0, 0)
    p.edges(1000)
    stop(p)
    shows(p, "STOPPED, phase kept", ">wait", " run on, same phase", " jog")
    p.short()
    assert p.mode == IDLE
    p.edges(1500)  # the hob turns on without the table
    at = p.position
    p.ticks(500_000)  # and stands
    p.knob(1)
    shows(p, "STOPPED, phase kept", " wait", ">run on, same phase", " jog")
    p.short()
    shows(p, "WAITS FOR THE PHASE", "Hob          0.0 rpm", "Table       0.00 rpm", "Lag           0 step")
    assert (p.mode, p.position) == (RUN, at)
    p.edges(4096 - 1500)  # a whole turn later the next tooth is in mesh; 2000 edges/s
    p.edges(20)  # 10 ms, after which it has kept up for long enough
    shows(p, " 32 teeth      32 DP", "Hob         29.3 rpm", "Table       0.92 rpm", "In phase: lag      0")
    p.edges(1980)
    assert abs(p.position - Fraction(16000, 32 * 4096) * 3000) <= Fraction(3, 2)


def test_a_turning_hob_is_engaged_and_caught_up_before_it_is_in_phase(panel):
    """At 8000 steps/s^2 and 1628 steps/s: the table speeds up for 0.2 s, and what it missed meanwhile is overtaken."""
    p = panel("hobbing_plewes", GM_ACCELERATION=8000)
    p.edges(10_000, ticks=20)  # 10 kHz: 146 rpm
    for _ in range(5):
        p.short()
    p.edges(1600, ticks=20)
    shows(p, " 24 teeth      32 DP", "Hob max      800 rpm", "HOB TURNS: KEEP FREE", "Start?   >no<  yes")
    p.knob(1)
    assert p.short() == SAVE
    p.edges(500, ticks=20)
    assert p.mode == RUN
    assert p.screen.startswith("CATCHING UP")
    for _ in range(30):
        p.edges(1000, ticks=20)
    shows(p, " 24 teeth      32 DP", "Hob        146.5 rpm", "Table       6.10 rpm", "In phase: lag      0")
    assert abs(p.position - Fraction(16000, 24 * 4096) * 30_500) <= Fraction(3, 2)


def test_after_power_up_the_last_job_is_there_but_not_its_phase(panel, new_settings):
    p = panel("hobbing_plewes")
    p.power_up(new_settings(teeth=127, hob_unit=0, depth_rule=0, hob_size=608_000, starts=2))
    shows(p, "Last job restored", "127 teeth    60.8 DP", "PHASE IS LOST", "Press: check the job")
    p.edges(500)
    assert (p.mode, p.position) == (IDLE, 0)
    p.short()
    shows(p, "Teeth            127", "Steps            125", "Edges           2032", "Press: next")


@pytest.mark.parametrize("foreign", [{"hob_size": 12_500}, {"teeth": 0}, {"profile": 1}])
def test_a_stored_job_of_another_machine_is_not_taken(panel, new_settings, foreign):
    p = panel("hobbing_plewes")
    p.power_up(new_settings(**foreign))
    shows(p, "No stored job", " 24 teeth      32 DP", "PHASE IS LOST", "Press: check the job")


def test_a_job_too_fast_for_the_driver_is_refused_with_the_limit_that_would_do(panel):
    p = panel("hobbing_plewes")
    p.short()
    p.knob(-18)  # 6 teeth
    p.short()
    p.short()
    p.knob(1)  # 2 starts
    shows(p, "Hob starts, right  2", "Steps            125", "Edges             96", "too many steps/s")
    p.short()
    p.short()
    shows(p, "  6 teeth      32 DP", "REFUSED", "too many steps/s", "Set limit    445 rpm")
    p.knob(1)
    assert p.short() == 0
    assert p.mode == IDLE


def test_helix_with_hand_lead_and_blank(panel):
    """m = 1, z = 30, 20 degrees: L = 275.562 mm; blank z/cos(20 deg) + 2 = 33.925 mm."""
    p = panel("hobbing_helical")
    p.short()
    p.knob(6)
    for _ in range(3):
        p.short()
    p.knob(5)
    p.knob(79, after_ms=20)
    p.knob(4, after_ms=50)
    shows(p, "Right hand 20.00 deg", "Lead      275.562 mm", "Blank      33.925 mm", "Press: next")
    p.knob(-160, after_ms=20)
    assert (p.edit.left, p.edit.helix) == (1, 1976)
    p.knob(-24)
    shows(p, "Left hand  20.00 deg", "Lead      275.562 mm", "Blank      33.925 mm", "Press: next")
    p.short()
    shows(p, " 30 teeth       1 m", "Hob max      800 rpm", "PHASE STARTS HERE", "Start?   >no<  yes")
    p.knob(1)
    p.short()
    before = p.position
    p.edges(20_000, ticks=20, axis=1)  # 20 mm of feed, 1000 counts per mm, counted in conventional cutting
    assert before == 0
    assert abs(p.position + 20 * 16000 / 275.562) <= 1
    p.knob(2)
    shows(p, " 30 teeth       1 m", "Checked       0 turn", "Steps          -1161", "Feed       20.000 mm")


def test_without_a_feed_encoder_the_helix_asks_for_the_feed_and_the_cut(panel):
    p = panel("hobbing_plewes")
    for _ in range(4):
        p.short()
    p.knob(1)
    p.short()
    shows(p, "Feed        0.250 mm", "per turn of table,", "must be constant", "Press: next")
    p.short()
    assert p.screen.startswith("Conventional cut    ")
    p.knob(1)
    assert p.screen.startswith("Climb cut           ")


def test_jog_moves_only_when_armed_and_every_step_is_counted_from_where_it_was_armed(panel):
    p = panel("hobbing_plewes")
    p.short()
    p.long()
    shows(p, "Menu", ">job", " jog", " test hob encoder")
    p.knob(1)
    p.short()
    p.knob(2)
    shows(p, "Jog by      1.00 deg", "Moved       0.00 deg", "Press: arm the knob", "Hold: menu")
    assert p.mode == IDLE
    p.short()
    for k in range(1, 8):
        p.knob(1)
        shows(p, "Jog by      1.00 deg", f"Moved       {k}.00 deg", "ARMED: knob moves", "MOVES  Press: stop")
        p.ticks(400_000)
        assert abs(p.position - Fraction(16000 * k, 360)) <= Fraction(1, 2)
    p.short()
    p.knob(1)
    assert p.mode == IDLE
    assert "Jog by     10.00 deg" in p.screen
    p.short()
    p.ticks(10)
    p.event(0, after_ms=61_000)  # nobody turned for a minute
    assert "Press: arm the knob" in p.screen


def test_dividing_goes_to_every_division_without_adding_up_errors(panel):
    p = panel("hobbing_plewes")
    p.short()
    p.long()
    p.knob(4)
    shows(p, "Menu", " test hob encoder", " test one turn", ">divide")
    p.short()
    p.knob(-17)
    shows(p, "Divide by          7", "Angle    51.4286 deg", "Press: 0 is here", "Hold: menu")
    p.short()
    shows(p, "At       0 of      7", "Go to              1", "Angle    51.4286 deg", "Press: go  Hold: end")
    assert p.mode == IDLE
    for k in range(1, 15):
        p.short()
        assert p.mode == MOVE
        p.ticks(3_000_000)
        assert abs(p.position - Fraction(16000 * k, 7)) <= Fraction(1, 2)
    shows(p, "At       0 of      7", "Go to              1", "Angle    51.4286 deg", "Press: go  Hold: end")
    p.knob(-2)
    p.short()  # division 6 is nearer backwards
    p.ticks(3_000_000)
    assert abs(p.position - Fraction(16000 * 13, 7)) <= Fraction(1, 2)


def test_a_press_stops_a_move(panel):
    p = panel("hobbing_plewes")
    p.short()
    p.long()
    p.knob(3)
    p.short()
    shows(p, "Mark the table", "Turn      16000 step", "Mark must come back", "Turn it? >no<  yes")
    p.knob(1)
    p.short()
    shows(p, "Mark the table", "Turn      16000 step", "Mark off? Check belt", "MOVES  Press: stop")
    p.ticks(200_000)
    p.short()
    p.ticks(200_000)
    assert p.mode == IDLE
    assert 0 < p.position < 16000
    shows(p, "Mark the table", "Turn      16000 step", "Mark must come back", "Move stopped")


def test_one_turn_of_the_table_is_one_turn(panel):
    p = panel("hobbing_plewes")
    p.short()
    p.long()
    p.knob(3)
    p.short()
    p.knob(1)
    p.short()
    p.ticks(3_000_000)
    assert (p.mode, p.position) == (IDLE, 16000)
    shows(p, "Mark the table", "Turn      16000 step", "Mark off? Check belt", "Turn it? >no<  yes")


@pytest.mark.parametrize(
    ("counts", "verdict"),
    [
        (4096, "OK within 1 %"),
        (4080, "OK within 1 %"),
        (-4100, "OK, but backwards"),
        (4000, "1000 lines, not 1024"),
        (1024, "1/4: decoder mode?"),
        (2048, "1/2: decoder mode?"),
        (8192, "x2: decoder mode?"),
        (16384, "x4: decoder mode?"),
        (3000, "WRONG: wiring, lines"),
        (0, "WRONG: wiring, lines"),
    ],
)
def test_one_turn_of_the_hob_names_the_mistake(panel, counts, verdict):
    p = panel("hobbing_plewes")
    p.short()
    p.long()
    p.knob(2)
    p.short()
    shows(p, "Test hob encoder", "Press, turn it once", "by hand, press again", "Hold: menu")
    p.edges(123)
    p.short()
    p.edges(counts)
    shows(p, "Turn once by hand", f"Counted{counts:13}", "Wanted          4096", "Press: turned once")
    p.short()
    p.edges(77)
    shows(p, verdict, f"Counted{counts:13}", "Wanted          4096", "Press: again")


def test_a_fault_takes_the_screen_and_without_the_output_the_operator_must_stop_the_hob(panel):
    p = panel("hobbing_plewes")
    start(p, -18, 0, 0, 0)  # 6 teeth
    p.edges(400, ticks=3)  # 67 kHz, for 800 rpm are 55 kHz
    shows(p, "FAULT hob too fast", "Hob max      800 rpm", "YOU MUST STOP HOB!", "Follows till it ends")
    for _ in range(5):
        p.short()
        p.knob(2)
    assert p.mode == RUN
    p.ticks(60_000)  # the hob stands, the table is sound
    assert p.mode == FAULT
    shows(p, "FAULT hob too fast", "Hob max      800 rpm", "YOU MUST STOP HOB!", "Phase kept. Hold: on")
    p.long()
    assert p.mode == IDLE
    shows(p, "STOPPED, phase kept", ">wait", " run on, same phase", " jog")


def test_a_table_that_cannot_follow_is_a_fault(panel):
    p = panel("hobbing_plewes", GM_MAX_LAG=2)
    start(p, -18, 0, 0, 0)
    p.edges(30, ticks=1)
    shows(p, "FAULT table lags", "Run the hob slower", "YOU MUST STOP HOB!", "Hold: acknowledge")


def test_lost_edges_are_a_fault(panel):
    p = panel("lathe_example")
    start(p, 0, 0, 0, 0)
    p.edges(6 * 4000, ticks=50)  # six turns, and the wired index pulse never came
    rows = p.screen.split("\n")
    assert rows[0] == "FAULT hob encoder   "
    assert rows[1].startswith("Cable? off by ")
    assert 4000 <= abs(int(rows[1][14:])) <= 6 * 4000
    assert rows[2:] == ["Hob was switched off", "Hold: acknowledge   "]


def test_an_emergency_stop_is_acknowledged_only_when_released(panel):
    p = panel("hobbing_helical")
    start(p, 0, 0, 0, 0)
    p.estop(True)
    p.ticks(60_000)
    shows(p, "EMERGENCY STOP", "Release the button", "Hob was switched off", "Phase kept. Hold: on")
    p.long()
    shows(p, "EMERGENCY STOP", "Release the button", "Hob was switched off", "The cause is there")
    p.estop(False)
    p.ticks(10_000)
    p.long()
    shows(p, "STOPPED, phase kept", ">wait", " run on, same phase", " jog")


def test_a_fault_of_the_drive_loses_the_phase_and_asks_for_a_job(panel):
    p = panel("hobbing_helical", GM_MAX_LAG=2)
    start(p, 0, 0, 0, 0)
    p.edges(200, ticks=0)
    shows(p, "FAULT table lags", "Run the hob slower", "Hob was switched off", "Hold: acknowledge")
    p.ticks(10_000)
    p.long()
    shows(p, "Teeth             24", "Steps            125", "Edges            768", "PHASE LOST: set up")
    p.knob(1)
    shows(p, "Teeth             25", "Steps              5", "Edges             32", "Press: next")


def test_a_hob_that_turns_in_a_move_is_a_fault(panel):
    p = panel("hobbing_helical")
    p.short()
    p.long()
    p.knob(3)
    p.short()
    p.knob(1)
    p.short()
    p.edges(20, ticks=1000)
    shows(p, "FAULT hob turned", "Lock it for moves", "Hob was switched off", "Hold: acknowledge")


@pytest.mark.parametrize(
    ("machine", "stops"), [("hobbing_plewes", "YOU MUST STOP HOB!"), ("hobbing_default", "Hob was switched off")]
)
@pytest.mark.parametrize("row", FAULT_MATRIX, ids=lambda row: row.page)
def test_every_fault_of_the_table_of_the_readme_shows_its_page_and_what_is_kept(panel, row, machine, stops):
    p = panel(machine)
    p.library.board_fault_page(row.fault, int(row.kept))
    rows = [line.rstrip() for line in p.screen.split("\n")]
    assert (rows[0], rows[2]) == (row.page, stops)
    assert rows[3] == ("Phase kept. Hold: on" if row.kept else "Hold: acknowledge")


def test_the_press_that_meets_a_fault_is_not_taken_for_another_page(panel):
    p = panel("hobbing_helical")
    start(p, 0, 0, 0, 0)
    p.library.board_estop(1)
    p.library.board_ticks(60_000)
    p.library.board_estop(0)
    p.library.board_ticks(100)
    p.long()  # on the page of the run, where it asks "Stop?"
    assert p.mode == FAULT
    shows(p, "EMERGENCY STOP", "Release the button", "Hob was switched off", "Phase kept. Hold: on")


def test_a_thread_in_mm_in_tpi_and_a_feed(panel):
    p = panel("lathe_example")
    shows(p, "No stored job", "Right       1.000 mm", "PHASE IS LOST", "Press: check the job")
    p.short()
    shows(p, "Lead screw", ">Thread in mm", " Thread in tpi", " Feed in mm per turn")
    p.short()
    p.knob(50)
    shows(p, "Pitch       1.250 mm", "Steps             60", "Edges            127", "Press: next")
    p.long()
    p.knob(1)
    p.short()
    p.knob(-34)
    # 25.4/11.5 mm x 4800/(25.4/8) steps/mm / 4000 = 96/115
    shows(p, "Pitch      11.50 tpi", "Steps             96", "Edges            115", "Press: next")
    p.long()
    p.knob(1)
    p.short()
    shows(p, "Feed/turn   0.100 mm", "Steps             24", "Edges            635", "Press: next")
    p.short()
    shows(p, "Right hand", "Steps             24", "Edges            635", "Press: next")
    p.knob(1)
    shows(p, "Left hand", "Steps            -24", "Edges            635", "Press: next")


def test_a_thread_is_left_and_picked_up_at_the_same_phase(panel):
    p = panel("lathe_example", GM_HAS_INDEX=0)
    start(p, 0, 100, 0, 0)  # 1.5 mm
    ratio = Fraction(3, 2) * Fraction(4800 * 40, 127) / 4000
    lead = ratio * 4000
    p.edges(8_123, ticks=30)
    assert abs(p.position - ratio * 8_123) <= Fraction(1, 2) + 2 * ratio  # two counts of hysteresis
    stop(p)
    p.knob(2)
    p.short()  # jog back, while the spindle turns on
    p.knob(3)
    shows(p, "Jog by      10.00 mm", "Moved        0.00 mm", "Press: arm the knob", "Hold: menu")
    p.short()
    p.knob(-1)
    p.edges(3_333, ticks=2000)
    assert p.mode == IDLE
    p.long()
    p.long()
    shows(p, "STOPPED, phase kept", ">wait", " run on, same phase", " jog")
    p.knob(1)
    p.short()
    assert p.mode == RUN
    p.edges(9_999, ticks=60)
    edges = 8_123 + 3_333 + 9_999
    off = (p.position - ratio * edges) / lead
    assert abs(off - round(off)) * lead <= Fraction(3, 2) + 2 * ratio
    assert round(off) < 0  # the carriage is back by whole leads


def test_the_starts_of_a_thread_are_cut_one_after_the_other(panel):
    p = panel("lathe_example", GM_HAS_INDEX=0)
    start(p, 0, 0, 1, 0)  # 1 mm, 2 starts
    shows(p, "Right       1.000 mm", "Spindle      0.0 rpm", "Thread start       1", "In phase: lag      0")
    pitch = Fraction(4800 * 40, 127)
    p.edges(6_000, ticks=40)
    stop(p)
    p.knob(6)
    shows(p, "STOPPED, phase kept", " shoulder is here", " back to start", ">next start")
    p.library.board_edges(0, 1000, 1, 100)
    p.short()
    shows(p, "STOPPED, phase kept", " shoulder is here", " back to start", "Stop spindle first")
    p.ticks(1_200_000)
    p.short()  # takes the message away
    p.short()
    assert p.mode == MOVE
    p.library.board_ticks(600_000)
    off = p.position - pitch * Fraction(7_000, 4000) * 2 - pitch  # modulo the lead of two pitches
    assert abs(off - round(off / (2 * pitch)) * 2 * pitch) <= Fraction(1, 2)
    p.event(0)
    shows(p, "STOPPED, phase kept", ">wait", " run on, same phase", "Next start is ready")
    assert p.position == 0  # the phase starts anew
    p.knob(1)
    p.short()
    shows(p, "Right       1.000 mm", "Spindle      0.0 rpm", "Thread start       2", "In phase: lag      0")


# --- the worker's helps ---------------------------------------------------------------------------------------------


def until_idle(p) -> None:
    for _ in range(800):
        if p.mode == IDLE:
            p.event(0)
            if p.mode == IDLE:
                return
        p.ticks(4000)
    raise AssertionError("it never stands")


PITCH = Fraction(4800 * 40, 127)  # motor steps per mm: 4800 a turn of 127/40 mm


def test_a_thread_ends_at_the_shoulder_and_its_next_pass_meets_the_groove(panel):
    p = panel("lathe_example", GM_HAS_INDEX=0, GM_ACCELERATION=40_000)
    start(p, 0, 0, 0, 0)  # 1 mm
    stop(p)
    p.knob(2)
    p.short()  # jog
    p.knob(3)  # 10 mm
    p.short()
    p.knob(1)
    until_idle(p)
    place = p.position
    assert abs(place - 10 * PITCH) <= 1
    p.short()
    p.long()
    p.long()
    p.knob(4)
    shows(p, "STOPPED, phase kept", " new job", ">shoulder is here", " back to start")
    p.short()
    shows(p, "STOPPED, phase kept", " new job", ">shoulder is here", "Shoulder is set")
    p.knob(1)
    p.short()
    until_idle(p)
    assert p.position == 0
    turned = 0
    for _ in range(3):
        p.knob(-6)
        p.knob(1)
        p.short()
        assert p.mode == RUN
        while p.mode == RUN:
            p.edges(500)  # 5000 edges/s: 75 rpm
            turned += 500
            assert p.position < place
            assert turned < 3 * 14 * 4000
        assert place - 20 < p.position < place  # it brakes over 45 steps, from 1890 steps/s with 40000 steps/s^2
        p.event(0)
        assert p.screen.endswith("SHOULDER: tool out  ")
        p.short()
        p.knob(5)
        p.short()
        until_idle(p)
        assert p.position == 0
    # once more until the middle: the place of the carriage is that of the thread, modulo its lead
    p.knob(-6)
    p.knob(1)
    p.short()
    for _ in range(14):
        p.edges(2000)
        turned += 2000
    assert "In phase" in p.screen
    lead, off = PITCH, Fraction(p.position) - PITCH * Fraction(turned, 4000)
    assert abs(off - round(off / lead) * lead) <= 2


def test_time_to_the_shoulder_is_shown(panel):
    p = panel("lathe_example", GM_HAS_INDEX=0)
    start(p, 0, 0, 0, 0)
    p.library.board_shoulder(int(30 * PITCH))
    p.edges(40_000, ticks=25)  # 10 turns in 2 s, 10 mm
    p.knob(1)
    rows = p.screen.split("\n")
    assert rows[3].startswith("Shoulder in")
    assert float(rows[3].split()[2]) == pytest.approx(4.0, abs=0.15)  # 20 mm at 5 mm/s


def test_the_phase_alone_is_set_where_tool_and_thread_touch(panel):
    """After power off: the tool stands in the thread, the spindle anywhere; from there on it is the same thread."""
    p = panel("lathe_example", GM_HAS_INDEX=0)
    p.library.board_edges(0, 1234, 1, 40)  # somewhere
    p.ticks(200_000)
    p.short()
    for _ in range(4):
        p.short()
    p.knob(2)
    shows(p, "Right       1.000 mm", "Max speed   1000 rpm", "PHASE STARTS HERE", ">Only set the phase<")
    assert p.short() == SAVE
    assert (p.mode, p.position) == (IDLE, 0)
    shows(p, "STOPPED, phase kept", ">wait", " run on, same phase", "Phase is set here")
    p.short()
    p.edges(2600, ticks=40)  # the spindle runs up without the carriage
    p.knob(1)
    p.short()
    p.edges(8000, ticks=40)
    off = Fraction(p.position) - PITCH * Fraction(10_600, 4000)
    assert abs(off - round(off / PITCH) * PITCH) <= 2


def test_spindle_of_a_lathe_is_read_in_divisions(panel):
    p = panel("lathe_example", GM_HAS_INDEX=0)
    p.short()
    p.long()
    p.knob(4)
    shows(p, "Menu", " test hob encoder", " test one turn", ">divide")
    p.short()
    p.knob(-18)  # 24 to 6
    shows(p, "Divide by          6", "Angle    60.0000 deg", "Press: 0 is here", "Hold: menu")
    p.short()
    shows(p, "At       0 of      6", "Angle      0.000 deg", "Beside it  0.000 deg", "Press: 0  Hold: end")
    p.edges(1300)  # 117 degrees
    shows(p, "At       2 of      6", "Angle    117.000 deg", "Beside it -3.000 deg", "Press: 0  Hold: end")
    p.edges(-1350)  # -4.5 degrees
    shows(p, "At       0 of      6", "Angle    355.500 deg", "Beside it -4.500 deg", "Press: 0  Hold: end")


@pytest.mark.parametrize("play", [0, 40])
def test_dividing_comes_to_every_place_forwards(panel, play):
    """Of motor steps back and forth the table sees only those beyond the play: a model of a loose worm."""
    p = panel("hobbing_plewes", GM_BACKLASH_STEPS=play)
    p.short()
    p.long()
    p.knob(4)
    p.short()  # divide by 24
    p.short()
    table = motor = 0
    places = []
    for detents in (0, 4, -9, 6):
        p.knob(detents)
        p.short()
        for _ in range(4000):
            p.ticks(40)
            motor = p.position
            table = min(
                max(table, motor - play), motor
            )  # driven forwards at `table = motor - play`... backwards at motor
            if p.mode == IDLE:
                p.event(0)
                if p.mode == IDLE:
                    break
        places.append((motor, table))
    # all places were reached from the same side: the table is behind the motor by the same play
    assert len({motor - table for motor, table in places}) == 1


def test_running_on_after_a_motion_backwards_takes_up_the_play(panel):
    p = panel("lathe_example", GM_HAS_INDEX=0, GM_BACKLASH_STEPS=30)
    start(p, 0, 0, 0, 0)
    p.edges(4000, ticks=25)
    stop(p)
    p.knob(2)
    p.short()
    p.knob(2)
    p.short()
    p.knob(-1)  # 1 mm back
    until_idle(p)
    at = p.position
    p.short()
    p.long()
    p.long()
    p.knob(1)
    p.short()
    seen = set()
    for _ in range(2000):
        p.ticks(100)
        seen.add(p.position)
        if p.mode == RUN:
            break
    assert p.mode == RUN
    assert (min(seen), p.position) == (at - 30, at)


def test_time_left_of_a_pass_is_that_of_the_pass_before(panel):
    """50 teeth: 20 turns of the hob are 0.4 turns of the table. The next gear, half as far at 5 turns/s of the hob, has
    10 turns of it left: 2 s."""
    p = panel("hobbing_plewes")
    start(p, 26, 0, 0, 0)
    p.edges(20 * 4096, ticks=10)
    for _ in range(3):
        p.knob(1)
    assert [row.strip() for row in p.screen.split("\n")[1:]] == ["This pass  0.40 turn", "No pass before", ""]
    stop(p)
    p.ticks(500_000)
    p.knob(1)
    p.short()  # run on
    p.edges(10 * 4096, ticks=10)
    for _ in range(3):
        p.knob(1)
    rows = p.screen.split("\n")
    assert rows[1].split() == ["This", "pass", "0.20", "turn"]
    assert rows[2].split() == ["Last", "pass", "0.40", "turn"]
    assert rows[3].split()[:2] == ["Pass", "left"]
    assert float(rows[3].split()[2]) == pytest.approx(2.05, abs=0.06)  # at 20 000 edges/s, one decimal
    p.edges(11 * 4096, ticks=10)
    assert p.screen.split("\n")[3].strip() == ""  # longer than the last one
