"""What ``gearmath gearbox`` prints for people: the plan of a job, and what a simulation found."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from gearmath.errors import counted
from gearmath.gearbox.job import PROPOSED, GearboxJob, ThreadPlan
from gearmath.gearbox.motion import HOPELESS_TURNS
from gearmath.gearbox.simulation import Simulation
from gearmath.gearbox.train import GearboxPlan, HobbedBlank
from gearmath.specs.hobbing import HobbingMachine
from gearmath.specs.motion_limits import EASY_MOTOR, hurries, motor_rpm
from gearmath.specs.ratio import EXACT_INCH, INCH, PI


def plan_text(job: GearboxJob, machine: HobbingMachine) -> str:
    """The plan of a gear or of a thread on a machine."""
    if isinstance(job, ThreadPlan):
        rows = [*_thread(job), *_rates(job, "spindle"), *_motor(job, machine), *_motion(job, "spindle")]
    else:
        assert isinstance(job, GearboxPlan)
        rows = [*_gear(job), *_rates(job, "hob"), *_motor(job, machine), *_motion(job, "hob")]
        rows += [row for blank in job.blanks for row in _blank(blank)]
    return "\n".join(rows)


def simulation_text(result: Simulation, job: GearboxJob) -> str:
    """What became of the compiled rule and of the floating one."""
    feed = f" and {job.feed_numerator}/{job.steps_denominator} of the feed" if job.feed_numerator else ""
    moved = f" and the feed at {result.feed_position}" if job.feed_numerator else ""
    leading, driven = ("spindle", "lead screw") if isinstance(job, ThreadPlan) else ("hob", "table")
    return "\n".join(
        [
            f"{result.edges} edges, {result.pattern}, {job.steps_numerator}/{job.steps_denominator} "
            f"steps per count{feed}; the {leading} ends at count {result.encoder_position}{moved}",
            f"  compiled integer rule    worst error {float(result.worst_error):10.4f} steps, "
            f"exactly {result.worst_error}; the {driven} ends at step {result.position}",
            f"  float32 rule             worst error {float(result.float_worst_error):10.4f} steps; "
            f"the {driven} ends at step {result.float_position}",
        ]
    )


def _rates(job: GearboxJob, what: str) -> Iterator[str]:
    proposed = abs(job.rpm - PROPOSED * job.highest_rpm) < 1e-9 * job.highest_rpm
    margin = f", {1 - PROPOSED:.0%} of it kept as a margin" if proposed else ""
    most = f"({job.highest_rpm:.1f} rpm at most{margin})"
    yield f"  {what:7s}{job.rpm:9.1f} rpm   {job.hob_rpm_percent:5.1f} % of the limit {most}"
    yield f"  edges  {job.edge_rate_hz:9.0f} Hz    {job.edge_rate_percent:5.1f} % of the limit"
    yield f"  steps  {job.step_rate_hz:9.0f} Hz    {job.step_rate_percent:5.1f} % of the limit"


def _motor(job: GearboxJob, machine: HobbingMachine) -> Iterator[str]:
    rpm = motor_rpm(machine, job.step_rate_hz)
    quick = f": a step motor has little torque above {EASY_MOTOR} rpm" * (hurries(machine) and rpm > EASY_MOTOR)
    yield f"  motor  {rpm:9.0f} rpm{quick}"


def _motion(job: GearboxJob, what: str) -> Iterator[str]:
    motion = job.motion
    yield (
        f"  run-up {motion.run_up_s:9.2f} s     of the motor: the {what} stays in phase up to "
        f"{motion.hob_acceleration_rpm_per_s:.0f} rpm/s, {motion.shortest_run_up_s:.2f} s are followed within the lag; "
        "a faster start or stop loses job and phase"
    )
    if motion.catch_up_s is not None:
        yield (
            f"  engage {motion.catch_up_s:9.2f} s     at this speed until in phase, which are "
            f"{motion.catch_up_turns:.1f} turns of the {what}"
        )
    else:
        yield (
            f"  engage only up to {motion.engage_rpm:.0f} rpm: above, catching up takes more than "
            f"{HOPELESS_TURNS:.0f} turns of the {what}, where the firmware gives up; a higher "
            "limits.acceleration_hz_per_s helps"
        )


def _resolution(count_um: float, step_um: float, where: str) -> str:
    """Which of encoder and motor limits, and what would help."""
    coarser = "step" if step_um > count_um else "count"
    help_ = "more microsteps or reduction" if coarser == "step" else "an encoder of more lines"
    arcs = f"{count_um:9.2f} um a count, {step_um:.2f} um a step {where}"
    return f"resolution     {arcs}: the {coarser} limits, {help_} helps"


def _thread(job: ThreadPlan) -> Iterator[str]:
    tpi = EXACT_INCH / job.pitch
    yield f"{job.machine}: {job.hand}-hand thread of {float(job.pitch):.6g} mm ({float(tpi):.6g} tpi)"
    if not _settable(job.pitch):
        yield "  not on the display: its knob goes by 0.005 mm of pitch or module, and by 0.25 threads per inch or DP"
    if job.starts > 1:
        yield f"  {job.starts} starts, lead {float(job.lead):.6g} mm"
    yield f"  R = {job.exact_pulse_ratio} = {job.pulse_ratio:.9g} encoder counts per motor step"
    yield "  " + _resolution(job.count_um, job.step_um, "of the carriage")


def _settable(pitch: Fraction) -> bool:
    """Whether the pages of the firmware can be turned to a pitch, in mm, tpi, module or diametral pitch."""
    lengths = (pitch, pitch / PI)
    return any((200 * length).denominator == 1 or (4 * EXACT_INCH / length).denominator == 1 for length in lengths)


def _gear(job: GearboxPlan) -> Iterator[str]:
    shift = f", profile shift {job.profile_shift:g}" if job.profile_shift else ""
    yield f"{job.machine}: {counted(job.teeth, 'tooth')}{shift}, {job.hob_starts}-start {job.hob_hand}-hand hob"
    if not job.carried_at_every_speed:
        yield (
            f"  REFUSED by the firmware as the machine file is: with limits.hob_rpm above {int(job.highest_rpm)} its "
            "motor needs too many steps/s; write at most that for it, and export anew. What follows is for that speed."
        )
    yield f"  R = {job.exact_pulse_ratio} = {job.pulse_ratio:.9g} encoder counts per motor step"
    if job.helix is None:
        return
    helix = job.helix
    yield f"  helix {helix.helix_deg:g} deg {helix.hand} hand, lead {helix.lead:.4f} mm, {helix.cut} cut"
    if abs(100.0 * helix.helix_deg - round(100.0 * helix.helix_deg)) > 1e-9:
        yield f"  not on the display: its knob goes by 0.01 deg, {helix.helix_deg:.2f} is another ratio"
    if helix.feed_mm is None:
        yield f"  feed {job.feed_numerator}/{job.steps_denominator} motor steps per count of the feed encoder"
    else:
        yield f"  feed {helix.feed_mm:g} mm per turn of the table, to be kept: its ratio is in R"
        if abs(100.0 * helix.feed_mm - round(100.0 * helix.feed_mm)) > 1e-9:
            yield f"  not on the display: its knob goes by 0.01 mm, {helix.feed_mm:.2f} is another ratio"
    yield (
        f"  rounding the lead costs {helix.error_steps:.1e} steps over {helix.travel:g} mm "
        f"({helix.error_bound_steps:.1e} at most)"
    )


def _blank(blank: HobbedBlank) -> Iterator[str]:
    yield f"  {blank.hob}"
    yield f"    blank diameter {_length(blank.blank_diameter)}"
    yield f"    depth of cut   {_length(blank.cut_depth)}  ({blank.depth_rule})"
    if blank.reaches_axis:
        yield (
            f"    no gear: the depth of cut, {blank.cut_depth:.4f} mm, reaches the axis of a blank of "
            f"{blank.blank_diameter / 2:.4f} mm radius; more teeth are needed, or a profile shift (--shift)"
        )
        return
    core = blank.blank_diameter - 2 * blank.cut_depth
    if core < blank.cut_depth:
        yield f"    core           {_length(core)}  in diameter is all that the cut leaves"
    if blank.undercut is not None:
        yield (
            f"    undercut       below {blank.undercut.least_teeth:.1f} teeth; a profile shift of "
            f"{blank.undercut.needed_shift:.3f} modules or more (--shift) avoids it"
        )
    if blank.swivel is not None:
        turn = "counter-clockwise" if blank.swivel.swivel > 0 else "clockwise"
        yield (
            f"    hob swivel     {abs(blank.swivel.swivel):9.3f} deg {turn}, seen from the hob towards the work "
            f"(lead angle {blank.swivel.lead_angle:.3f} deg)"
        )
    if blank.span is not None:
        needs = f", face width over {blank.span.face_width:.2f} mm" if blank.span.face_width else ""
        yield f"    span           {_length(blank.span.length)}  over {counted(blank.span.teeth, 'tooth')}{needs}"
    else:
        yield "    span           none: the jaws would not touch the involute on both sides of two teeth or more"
    if blank.chord is not None:
        yield f"    chord          {_length(blank.chord.thickness)}  at {blank.chord.height:.4f} mm below the tip"
    if blank.over_pins is not None:
        yield f"    over pins      {_length(blank.over_pins.length)}  of {blank.over_pins.pin:.4g} mm"
    else:
        yield "    over pins      none: such pins do not rest on the involute and stand out above the tips; try --pin"
    yield "    " + _resolution(blank.count_um, blank.step_um, "at the pitch circle")


def _length(value: float) -> str:
    return f"{value:9.4f} mm {value / INCH:8.4f} in"
