"""Every quantity, once: name, meaning, unit, LaTeX, domain.

Names follow ISO 23509, ISO 21771 and REXS (American spelling). Lengths are mm, angles rad. The domains are where the
expressions are valid and where the tests sample them; people's limits belong to the files in ``gearmath.specs``.
"""

from __future__ import annotations

from fractions import Fraction
from math import pi

from derivations.quantity import Quantity

#: |V_c × V_p| below which a pose of the machine counts as singular.
SINGULAR_SINE = Fraction(1, 20)
#: Distance reported where a line never meets the cutter: farther away than any tooth space is wide. [mm]
NOWHERE = 1000


def _length(name: str, latex: str, low: float, high: float, description: str) -> Quantity:
    return Quantity(name, description, "mm", latex, (low, high), scale=100.0)


def _angle(name: str, latex: str, low: float, high: float, description: str) -> Quantity:
    return Quantity(name, description, "rad", latex, (low, high))


def _vector(name: str, latex: str, unit: str, scale: float, bound: float, description: str) -> Quantity:
    return Quantity(name, description, unit, latex, (-bound, bound), shape=(3,), scale=scale)


def _count(name: str, latex: str, low: int, high: int, description: str) -> Quantity:
    return Quantity(name, description, "1", latex, (low, high), kind="int")


def _factor(name: str, latex: str, low: float, high: float, description: str) -> Quantity:
    return Quantity(name, description, "1", latex, (low, high))


# --- cutter -----------------------------------------------------------------------------------------------------
u = _length("u", "u", 0.0, 15.0, "height of the blade point above the tip plane, along the cutter axis")
beta = _angle("beta", r"\beta", -pi, pi, "cutter angle of the blade point, about the cutter axis")
side = Quantity(
    "side", "+1 outer blade (concave flank), -1 inner blade (convex flank)", "1", "s", (-1, 1), values=(-1, 1)
)
blade_point_radius = _length("blade_point_radius", "r_p", 20.0, 250.0, "radius of the blade tip about the cutter axis")
blade_pressure_angle = _angle("blade_pressure_angle", r"\alpha", 0.05, 0.6, "angle between blade and cutter axis")
point_c = _vector("point_c", r"\mathbf{r}_c", "mm", 100.0, 250.0, "point of the cutter surface, cutter frame T")
normal_c = _vector(
    "normal_c", r"\mathbf{n}_c", "1", 1.0, 1.0, "unit normal of the cutter surface into the cutter, frame T"
)

# --- machine settings -------------------------------------------------------------------------------------------
radial_distance = _length("radial_distance", "S", 20.0, 200.0, "machine centre to cutter centre in the machine plane")
cradle_angle = _angle("cradle_angle", "q", -1.5, 1.5, "polar angle of the cutter centre at cradle rotation zero")
cutter_tilt = _angle("cutter_tilt", "i", -0.4, 0.4, "tilt of the cutter axis against the cradle axis")
cutter_swivel = _angle("cutter_swivel", "j", -pi, pi, "direction of the tilt, about the cradle axis")
blank_offset = _length("blank_offset", "E_m", -40.0, 40.0, "work axis to machine centre, along machine axis j")
sliding_base = _length("sliding_base", "X_b", -20.0, 20.0, "withdrawal of the work along the cradle axis")
machine_center_to_crossing_point = _length(
    "machine_center_to_crossing_point", "X_p", -20.0, 20.0, "advance of the work along its own axis"
)
advance_from_crossing_point = _length(
    "advance_from_crossing_point", "X_C", -20.0, 20.0, "advance of the work, its crossing point taken for its apex"
)
pitch_apex_beyond_crossing_point = _length(
    "pitch_apex_beyond_crossing_point", "t_z", -20.0, 20.0, "pitch apex beyond the crossing point, seen from the teeth"
)
machine_root_angle = _angle("machine_root_angle", r"\Gamma", -0.2, 1.45, "work axis against the machine plane")
ratio_of_roll = Quantity("ratio_of_roll", "work rotation per cradle rotation", "1", "R_a", (0.5, 8.0), scale=1.0)
work_rotation_offset = _angle("work_rotation_offset", r"\varphi_0", -pi, pi, "work rotation at cradle rotation zero")

settings = Quantity(
    "settings",
    "machine and cutter settings of one flank",
    "mixed",
    r"\mathbf{x}",
    shape=(12,),
    components=(
        radial_distance,
        cradle_angle,
        cutter_tilt,
        cutter_swivel,
        blank_offset,
        sliding_base,
        machine_center_to_crossing_point,
        machine_root_angle,
        ratio_of_roll,
        work_rotation_offset,
        blade_point_radius,
        blade_pressure_angle,
    ),
)

# --- cradle machine ---------------------------------------------------------------------------------------------
theta = _angle("theta", r"\theta", -1.0, 1.0, "cradle rotation (roll position)")
work_angle = Quantity("work_angle", "rotation of the work about its axis", "rad", r"\varphi_w", scale=10.0)
V_c = _vector(
    "V_c", r"\mathbf{V}_c", "1", 1.0, 1.0, "cutter axis, from the cutter head towards the work, machine frame s"
)
V_p = _vector(
    "V_p", r"\mathbf{V}_p", "1", 1.0, 1.0, "work axis, from the crossing point towards the heel, machine frame s"
)
V_ls = _vector("V_ls", r"\mathbf{V}_{ls}", "mm", 200.0, 500.0, "pitch apex to cutter centre, machine frame s")
point_w = _vector("point_w", r"\mathbf{R}", "mm", 300.0, 500.0, "point of the tooth surface family, work frame w")
normal_w = _vector("normal_w", r"\mathbf{n}", "1", 1.0, 1.0, "outward unit normal (out of the metal), work frame w")
meshing_residual = Quantity(
    "meshing_residual",
    "normal speed of cutter against work per unit of cradle speed, zero in contact",
    "mm/rad",
    "f",
    scale=1000.0,
)
sensitivity = Quantity(
    "sensitivity",
    "deviation per unit of every setting at the contact point",
    "mixed",
    r"\partial\delta/\partial\mathbf{x}",
    shape=(12,),
    scale=1000.0,
)

# --- vertical machine -------------------------------------------------------------------------------------------
X = Quantity("X", "position of axis X", "mm", "X", (-500.0, 500.0), scale=300.0)
Y = Quantity("Y", "position of axis Y", "mm", "Y", (-500.0, 500.0), scale=300.0)
Z = Quantity("Z", "position of axis Z", "mm", "Z", (-500.0, 900.0), scale=600.0)
A = Quantity(
    "A", "position of the work axis A, right-handed about the work axis", "rad", "A", (-10.0, 10.0), scale=10.0
)
B = Quantity("B", "position of the swivel axis B, left-handed about Y", "rad", "B", (-0.2, 1.7), scale=1.0)
axes = Quantity(
    "axes",
    "axis positions X, Y, Z, A, B of the vertical machine",
    "mixed",
    r"\mathbf{a}",
    shape=(5,),
    components=(X, Y, Z, A, B),
)
pivot_height = _length(
    "pivot_height",
    "(R_d + C_t)",
    -1000.0,
    1000.0,
    "R_d + C_t: reading of Z with the blade tips level with the B axis",
)
pivot_offset = Quantity(
    "pivot_offset",
    "B axis to pitch apex, in the axes of the work at A = 0; zero where none is given",
    "mm",
    r"\mathbf{e}",
    (-100.0, 100.0),
    shape=(3,),
    scale=100.0,
    default=0.0,
)
point_m = _vector(
    "point_m", r"\mathbf{r}", "mm", 500.0, 1000.0, "point of the work from the cutter centre, axes of the machine"
)
psi = Quantity("psi", "position of the cutter's axis C at cutter angle zero", "rad", r"\psi")
C = Quantity("C", "position of the cutter's axis C, right-handed about the tool axis", "rad", "C", (-10.0, 10.0))
cutter_azimuth = Quantity(
    "cutter_azimuth", "position of C at which the cutter frame's axis i points to a place", "rad", r"\chi"
)
cutter_reference_w = _vector(
    "cutter_reference_w", r"\mathbf{i}_c", "1", 1.0, 1.0, "axis i of the turned cutter frame, work frame w"
)
cutter_center_w = _vector(
    "cutter_center_w", r"\mathbf{c}", "mm", 300.0, 500.0, "cutter centre in the tip plane, work frame w"
)
cutter_axis_w = _vector("cutter_axis_w", r"\mathbf{k}_c", "1", 1.0, 1.0, "cutter axis towards the work, work frame w")
line_point = _vector("line_point", r"\mathbf{p}", "mm", 300.0, 200.0, "point at distance zero of a line, work frame w")
line_direction = _vector("line_direction", r"\mathbf{d}", "1", 1.0, 1.0, "unit direction of a line, work frame w")
line_distance = Quantity(
    "line_distance", "where the line enters the swept blade; 1e3 where it does not", "mm", "t", scale=1000.0
)
line_start = _length("line_start", "t_s", -20.0, 0.0, "where on a line the search begins, within the tooth")
line_place = _length("line_place", "t", -20.0, 20.0, "distance along a line from its point")
blade_slope = Quantity("blade_slope", "tan of the blade's angle against the cutter axis", "1", r"\tau", (0.05, 0.7))
line_lower = _length("line_lower", "t_1", -100.0, 100.0, "where a line comes into a cone; above its end if never")
line_upper = _length("line_upper", "t_2", -100.0, 100.0, "where a line leaves a cone")
hole_lower = _length("hole_lower", "t_3", -100.0, 100.0, "where a line comes into the inner cone")
hole_upper = _length("hole_upper", "t_4", -100.0, 100.0, "where a line leaves the inner cone")


def _blade(which: str, mark: str, low: float, high: float) -> Quantity:
    text = f"of the {which} blade"
    return Quantity(
        f"{which}_blade",
        f"straight or curved flank and rounded edge {text}",
        "mixed",
        rf"\mathbf{{b}}_{mark}",
        shape=(7,),
        components=(
            _length(f"{which}_flank_radius", f"r_{mark}", low, high, f"point radius of the cone at the flank {text}"),
            _angle(f"{which}_flank_angle", rf"\alpha_{mark}", 0.05, 0.6, f"pressure angle {text}"),
            Quantity(
                f"{which}_curvature",
                f"curvature of the flank {text}, convex positive",
                "1/mm",
                rf"\kappa_{mark}",
                (-0.005, 0.005),
            ),
            _length(f"{which}_reference", f"h_{{r{mark}}}", 0.0, 10.0, f"height where arc and cone touch {text}"),
            _length(f"{which}_edge_center", rf"\rho_{{e{mark}}}", low, high, f"radius of the edge's centre {text}"),
            _length(f"{which}_edge_radius", f"r_{{e{mark}}}", 0.0, 3.0, f"radius of the rounded edge {text}"),
            _angle(f"{which}_joint", f"u_{{j{mark}}}", 0.05, 0.6, f"normal's angle where edge and flank join {text}"),
        ),
    )


outer_blade = _blade("outer", "o", 40.0, 250.0)
inner_blade = _blade("inner", "i", 40.0, 250.0)
tip_height = _length("tip_height", "h", -20.0, 20.0, "height of a place above the tip plane of the cutter")
axis_distance = _length("axis_distance", r"\rho", 20.0, 270.0, "distance of a place from the cutter axis")
excess = Quantity("excess", "distance outside of the cutter, negative within it", "mm", "E", scale=300.0)
eccentricity = _length("eccentricity", "e", 0.0, 1.0, "distance of the work's axis from the axis that turns it")
eccentricity_azimuth = _angle("eccentricity_azimuth", r"\mu", -pi, pi, "direction of the eccentricity in the work")
work_tilt = _angle("work_tilt", r"\varepsilon", 0.0, 0.02, "tilt of the work's axis against the axis that turns it")
tilt_azimuth = _angle("tilt_azimuth", r"\lambda", -pi, pi, "azimuth of the axis of the tilt in the work")
seated_point = _vector("seated_point", r"\mathbf{R}_a", "mm", 300.0, 500.0, "point of the seated work, turning with A")
seated_normal = _vector("seated_normal", r"\mathbf{n}_a", "1", 1.0, 1.0, "its outward unit normal, turning with A")

motion_sensitivity = Quantity(
    "motion_sensitivity",
    "deviation per unit of a small motion of the work: along x, y, z and about x, y, z",
    "mixed",
    r"\partial\delta/\partial(\mathbf{t}, \boldsymbol{\omega})",
    shape=(6,),
    scale=1000.0,
)

# --- deviation --------------------------------------------------------------------------------------------------
tip_center = _vector(
    "tip_center", r"\mathbf{p}_m", "mm", 300.0, 500.0, "centre of the probe tip at contact, work frame w"
)
tip_radius = _length(
    "tip_radius", "r_m", 0.0, 5.0, "effective radius of the probe tip; zero for a corrected contact point"
)
deviation = Quantity("deviation", "along the outward normal; positive = metal left on", "mm", r"\delta", scale=300.0)
lengthwise = _length("lengthwise", "X_t", -50.0, 50.0, "distance from the reference point along the tooth, toe to heel")
profilewise = _length(
    "profilewise", "Y_t", -20.0, 20.0, "distance from the reference point up the profile, root to tip"
)
surface_coefficients = Quantity(
    "surface_coefficients",
    "coefficients c_1 ... c_10 of the cubic deviation surface, mm per mm^k",
    "mixed",
    "c",
    (-1.0, 1.0),
    shape=(10,),
)
monomials = Quantity("monomials", "1, X, Y, X^2, XY, Y^2, X^3, X^2 Y, X Y^2, Y^3", "mixed", "m", shape=(10,), scale=1e5)
surface_deviation = Quantity(
    "surface_deviation", "deviation that the cubic surface gives at one point", "mm", r"\delta", scale=1e5
)

evaluated_length = _length("evaluated_length", "a", 1.0, 100.0, "length of the evaluated area, toe to heel")
evaluated_height = _length("evaluated_height", "b", 1.0, 40.0, "height of the evaluated area, root to tip")
spiral_angle_deviation = Quantity("spiral_angle_deviation", "rise, toe to heel", "mm", r"f_\beta", scale=1e3)
pressure_angle_deviation = Quantity("pressure_angle_deviation", "rise, root to tip", "mm", r"f_\alpha", scale=1e3)
length_crowning = Quantity("length_crowning", "middle over the ends, along the tooth", "mm", r"C_\beta", scale=1e4)
profile_crowning = Quantity("profile_crowning", "middle over the ends, up the profile", "mm", r"C_\alpha", scale=1e4)
twist = Quantity("twist", "rise root to tip at the heel less that at the toe", "mm", "S", scale=1e4)

# --- probing ----------------------------------------------------------------------------------------------------
standoff = _length("standoff", "s", -5.0, 20.0, "distance of the tip from the flank along the outward normal")
opposite_w = _vector(
    "opposite_w", r"\mathbf{R}'", "mm", 300.0, 500.0, "point of the opposite flank at the same place, work frame w"
)
touch_errors = Quantity(
    "touch_errors",
    "errors of the machine that measures, and growth of the work",
    "mixed",
    r"\mathbf{e}",
    shape=(6,),
    components=(
        Quantity("X_error", "error of axis X", "mm", "e_X", (-0.1, 0.1)),
        Quantity("Y_error", "error of axis Y", "mm", "e_Y", (-0.1, 0.1)),
        Quantity("Z_error", "error of axis Z", "mm", "e_Z", (-0.1, 0.1)),
        Quantity("A_error", "error of the work axis A", "rad", "e_A", (-1e-3, 1e-3)),
        Quantity("squareness", "shift of X for every mm of Z", "1", r"\sigma", (-1e-3, 1e-3)),
        Quantity("growth", "part by which the work is larger than its drawing", "1", r"\varepsilon", (-1e-3, 1e-3)),
    ),
)
seeming_deviation = Quantity(
    "seeming_deviation", "deviation that a perfect flank seems to have", "mm", r"\delta_e", scale=1000.0
)
probe_height = _length("probe_height", "H", 0.0, 900.0, "height of the tip over the B axis at Z = 0")
tip_offset = _vector("tip_offset", r"\mathbf{o}", "mm", 1.0, 5.0, "tip off the spindle axis and off its height, X Y Z")
stylus_w = _vector("stylus_w", r"\mathbf{k}_m", "1", 1.0, 1.0, "direction of the stylus, tip to spindle, work frame w")
contact_point = _vector("contact_point", r"\mathbf{P}", "mm", 300.0, 500.0, "corrected contact point, work frame w")
first_trigger = _length("first_trigger", "X_1", -500.0, 500.0, "position at the touch on the low side of the ring")
last_trigger = _length("last_trigger", "X_2", -500.0, 500.0, "position at the touch on the high side of the ring")
ring_center = _length("ring_center", "L", -500.0, 500.0, "known position of the centre of the ring")
ring_diameter = _length("ring_diameter", "D", 5.0, 200.0, "inner diameter of the calibration ring")
axis_offset = _length("axis_offset", "o", -5.0, 5.0, "offset of the tip along one axis")
ring_axis = Quantity(
    "ring_axis",
    "known place of the axis of the ring, X Y",
    "mm",
    r"\mathbf{L}",
    (-500.0, 500.0),
    shape=(2,),
    scale=300.0,
)
ring_rest = _length("ring_rest", r"\rho", -1e3, 1e3, "distance that a touch in the ring leaves unexplained")
seat_height = _length("seat_height", "D", 0.0, 900.0, "height of the seat of the ring: Z of a tip centre there")
ring_height = _length("ring_height", "F", 1.0, 100.0, "height of the ring above its seat")
face_trigger = _length("face_trigger", "Z_c", 0.0, 900.0, "position of Z at the touch on the face of the ring")
trigger = _vector("trigger", r"\mathbf{p}", "mm", 300.0, 500.0, "positions X, Y, Z at which the probe triggered")
sphere_center = _vector("sphere_center", r"\mathbf{c}", "mm", 300.0, 500.0, "centre of the calibration sphere, X Y Z")
sphere_radius = _length("sphere_radius", "R_s", 2.0, 50.0, "radius of the calibration sphere")
touch_normal = _vector(
    "touch_normal", r"\mathbf{m}", "1", 1.0, 1.0, "unit normal out of what is touched, axes of the machine"
)
lobing = Quantity(
    "lobing",
    "lobes of the effective radius: amplitude times cosine and sine of three times the azimuth of one",
    "mm",
    r"\mathbf{a}",
    (-0.02, 0.02),
    shape=(2,),
    scale=1.0,
    default=0.0,
)
lobing_amplitude = _length("lobing_amplitude", "a", 0.0, 0.02, "amplitude of the lobes of the effective radius")
lobing_phase = _angle("lobing_phase", r"\varphi_0", -pi / 3, pi / 3, "azimuth of a lobe of the effective radius")
effective_radius = _length("effective_radius", "r", 0.0, 5.0, "radius of the tip that a touch in its direction has")
sphere_w = _vector(
    "sphere_w", r"\mathbf{s}", "mm", 100.0, 200.0, "centre of a sphere that the work carries, work frame w"
)
axis_place = Quantity(
    "axis_place",
    "X and Z of the axis B beside where the zero of X and R_d have it",
    "mm",
    r"\mathbf{b}",
    (-5.0, 5.0),
    shape=(2,),
)
swivel_zero = _angle("swivel_zero", r"\beta_B", -0.02, 0.02, "how far B stands beyond what the control reads")
sphere_rest = _length("sphere_rest", r"\rho", -1e3, 1e3, "distance that a touch on the sphere leaves unexplained")

# --- spacing of the teeth ---------------------------------------------------------------------------------------
opposite_normal = _vector(
    "opposite_normal", r"\mathbf{n}'", "1", 1.0, 1.0, "outward unit normal of the opposite flank, work frame w"
)
opposite_deviation = Quantity("opposite_deviation", "deviation of the opposite flank", "mm", r"\delta'", (-0.5, 0.5))
cone_shift = Quantity(
    "cone_shift",
    "movement of a ball in a tooth space, along the normal of the pitch cone",
    "mm",
    r"\Delta",
    scale=100.0,
)
space_turning = Quantity(
    "space_turning", "angle by which a tooth space is turned about z_w", "rad", r"\varepsilon", scale=1.0
)
allowance = Quantity("allowance", "metal left on a flank, along the circle", "mm", "E", scale=300.0)
arc_deviation = Quantity("arc_deviation", "deviation of the thickness of a tooth, as an arc", "mm", "E_s", (-1.0, 1.0))
tooth_arc = _length("tooth_arc", "s", -5000.0, 5000.0, "thickness of a tooth along the circle through its points")
tooth_chord = _length("tooth_chord", "s_c", -2000.0, 2000.0, "straight thickness of a tooth between its points")
chord_deviation = Quantity("chord_deviation", "deviation of the thickness of a tooth, straight", "mm", "E_c")
trace_angle = _angle("trace_angle", r"\beta", 0.0, 1.6, "spiral angle at the mean point, by the normal of a flank")
module_found = _length("module_found", "m_{mn}", 0.0, 500.0, "mean normal module by the spiral angle of a flank")
tolerance_diameter = _length("tolerance_diameter", "d_T", 5.0, 2500.0, "diameter at half the working depth")
accuracy_grade = Quantity("accuracy_grade", "grade of accuracy, 2 is finest", "1", "B", (2, 11), kind="int")
single_pitch_tolerance = Quantity("single_pitch_tolerance", "allowed single pitch", "um", "f_{ptT}", scale=100.0)
cumulative_pitch_tolerance = Quantity(
    "cumulative_pitch_tolerance", "allowed cumulative pitch", "um", "F_{pT}", scale=100.0
)
runout_tolerance = Quantity("runout_tolerance", "allowed runout", "um", "F_{rT}", scale=100.0)

# --- electronic gearbox -----------------------------------------------------------------------------------------
teeth = _count("teeth", "G", 1, 999, "teeth of the gear to be cut")
hob_starts = _count("hob_starts", "k", 1, 10, "starts of the hob")
encoder_counts = _count(
    "encoder_counts", "N_{encoder}", 1, 40_000, "encoder counts per turn of the hob, after the decoder"
)
motor_steps = _count("motor_steps", "N_{motor}", 1, 10_000_000, "motor steps per turn of the work table")
pulse_ratio = Quantity("pulse_ratio", "encoder counts per motor step", "1", "R", (0.1, 100.0), scale=1.0)
encoder_position = _count("encoder_position", "e", -(2**31), 2**31, "encoder counts since the start, signed")
desired_position = Quantity("desired_position", "where the work should be", "steps", "P_{desired}", scale=1e6)
steps_numerator = _count("steps_numerator", "N", 1, 2**30, "N of the ratio N/D in motor steps per encoder count")
steps_denominator = _count("steps_denominator", "D", 1, 2**30, "D of the ratio N/D in motor steps per encoder count")
nearest_position = _count("nearest_position", "p", -(2**62), 2**62, "the whole step nearest to the desired position")
floor_position = _count(
    "floor_position", "N_{delivered}", -(2**62), 2**62, "steps delivered by the rule of the source text"
)
edge = Quantity("edge", "one encoder edge: +1 forward, -1 backward", "1", "d", (-1, 1), kind="int", values=(-1, 1))
remainder = _count("remainder", "a", 0, 2**30 - 1, "state of the step rule, 0 <= remainder < steps_denominator")
next_remainder = _count("next_remainder", "a'", 0, 2**30 - 1, "state of the step rule after the edge")
first_remainder = _count(
    "first_remainder", "a_0", 0, 2**29, "state of the step rule at the start: half of D, rounded down"
)
step = Quantity("step", "motor step to deliver: +1, 0 or -1", "1", r"\Delta p", (-1, 1), kind="int", values=(-1, 0, 1))
base_step = _count("base_step", "q", -64, 64, "whole steps that every edge gives; the ratio is q + N'/D")
increment = _count("increment", "N'", 0, 2**30 - 1, "rest of the ratio over the base step, 0 <= increment < D")
edge_steps = _count("edge_steps", r"\Delta p", -65, 65, "motor steps that one edge of one axis gives")
hysteresis = _count("hysteresis", "H", 0, 16, "encoder counts of play before a reversal is followed")
play = _count("play", "x", 0, 16, "state of the hysteresis, 0 <= play <= hysteresis")
next_play = _count("next_play", "x'", 0, 16, "state of the hysteresis after the edge")
passed_edge = Quantity(
    "passed_edge", "edge that is passed on: +1, 0 or -1", "1", "d'", (-1, 1), kind="int", values=(-1, 0, 1)
)

count_before = _count("count_before", "c", 0, 65_535, "reading of a 16-bit counter at the time before")
count_now = _count("count_now", "c'", 0, 65_535, "reading of a 16-bit counter now")
counted = _count("counted", "m", -32_768, 32_767, "counts between two readings")

step_rate = Quantity("step_rate", "steps per second while the motor follows at speed", "1/s", "w", (1.0, 1e6))
step_acceleration = Quantity("step_acceleration", "acceleration of the motor", "1/s^2", "a", (1.0, 1e7))
top_rate = Quantity("top_rate", "most steps per second", "1/s", r"w_{max}", (1.0, 1e6))
lag_limit = Quantity("lag_limit", "steps that may wait", "steps", "L", (1.0, 30_000.0))
run_up_time = Quantity("run_up_time", "time of the motor from rest to speed", "s", "t_r", scale=1e3)
missed_steps = Quantity(
    "missed_steps", "steps missed meanwhile by a motor that is engaged at speed", "steps", "m", scale=1e6
)
shortest_run_up = Quantity(
    "shortest_run_up", "shortest time in which the hob may come to speed, or stop", "s", "T_{min}", scale=1e3
)
overtaking_rate = Quantity("overtaking_rate", "by how much a motor that catches up is faster", "1/s", "u", scale=1e6)
catch_up_time = Quantity("catch_up_time", "time from engaging at speed until in phase", "s", "t_c", scale=1e6)
pitch_diameter = _length("pitch_diameter", "d", 0.01, 30_000.0, "reference diameter of the gear")
count_arc = Quantity("count_arc", "way of the pitch circle per encoder count", "um", r"\delta_e", scale=1e6)
step_arc = Quantity("step_arc", "way of the pitch circle per motor step", "um", r"\delta_p", scale=1e6)

# --- hobbed blank -----------------------------------------------------------------------------------------------
module = _length("module", "m", 0.1, 25.0, "normal module of the hob; 25.4/P for diametral pitch P")
depth_factor = Quantity("depth_factor", "whole depth in modules", "1", "f_h", (2.0, 2.5), scale=1.0)
depth_extra = _length("depth_extra", "h_+", 0.0, 0.1, "depth added to the factor by the fine-pitch rule")
blank_diameter = _length("blank_diameter", "d_a", 0.0, 1e4, "outside diameter of the blank")
cut_depth = _length("cut_depth", "h", 0.0, 100.0, "whole depth of cut")

# --- hobbing ----------------------------------------------------------------------------------------------------
pressure_angle = _angle("pressure_angle", r"\alpha_n", 0.15, 0.55, "normal pressure angle of the hob")
helix_angle = _angle("helix_angle", r"\beta", 0.0, 1.1, "helix angle of the gear at its reference cylinder")
helix_sign = Quantity("helix_sign", "+1 right-hand, -1 left-hand gear", "1", r"s_\beta", (-1, 1), values=(-1, 1))
hob_sign = Quantity("hob_sign", "+1 right-hand, -1 left-hand hob", "1", "s_h", (-1, 1), values=(-1, 1))
feed_sign = Quantity(
    "feed_sign",
    "+1 if the counts of the feed go up in climb hobbing, -1 if in conventional",
    "1",
    "s_f",
    (-1, 1),
    values=(-1, 1),
)
profile_shift = Quantity("profile_shift", "profile shift in normal modules", "1", "x", (-0.5, 1.0))
hob_diameter = _length("hob_diameter", "d_0", 5.0, 500.0, "reference diameter of the hob")
hob_lead_angle = _angle("hob_lead_angle", r"\lambda", 0.0, 1.5, "lead angle of the hob at its reference diameter")
hob_swivel = _angle(
    "hob_swivel", r"\eta", -pi, pi, "turn of the hob's axis, counter-clockwise seen from the hob towards the work"
)
transverse_module = _length("transverse_module", "m_t", 0.1, 60.0, "module in the plane normal to the gear's axis")
transverse_pressure_angle = _angle("transverse_pressure_angle", r"\alpha_t", 0.15, 1.2, "pressure angle in that plane")
base_helix_angle = _angle("base_helix_angle", r"\beta_b", 0.0, 1.1, "helix angle at the base cylinder")
reference_diameter = _length("reference_diameter", "d", 0.1, 1e5, "diameter of the reference cylinder")
base_diameter = _length("base_diameter", "d_b", 0.1, 1e5, "diameter of the base cylinder")
tip_diameter = _length("tip_diameter", "d_{at}", 0.1, 1e5, "outside diameter of the blank of a helical gear")
gear_lead = Quantity("gear_lead", "travel along the axis in which a tooth goes once round", "mm", "L", scale=1e5)
spanned_teeth = _count("spanned_teeth", "k", 1, 400, "number of teeth that the span takes in")
best_spanned_teeth = Quantity(
    "best_spanned_teeth",
    "number of teeth at which the span touches at d + 2 x m_n, before rounding",
    "1",
    "k_{th}",
    scale=100.0,
)
span = _length("span", "W_k", 0.0, 1e5, "base tangent length over the spanned teeth")
span_contact_diameter = _length("span_contact_diameter", "d_W", 0.0, 1e5, "diameter at which the span touches")
span_face_width = _length("span_face_width", "b_W", 0.0, 1e5, "face width below which a span finds no second contact")
tooth_thickness = _length("tooth_thickness", "s_n", 0.0, 200.0, "normal tooth thickness at the reference cylinder")
thickness_half_angle = _angle("thickness_half_angle", r"\psi", 0.0, 3.0, "half the angle of that thickness")
chordal_thickness = _length("chordal_thickness", r"\bar{s}", 0.0, 200.0, "chord of the tooth thickness")
chordal_height = _length("chordal_height", r"\bar{h}_a", 0.0, 200.0, "height of the tip above that chord")
pin_diameter = _length("pin_diameter", "d_p", 0.1, 60.0, "diameter of the measuring pins or balls")
pin_angle = _angle("pin_angle", r"\varphi", 0.05, 1.3, "transverse pressure angle at the centre of the pin")
pin_residual = Quantity("pin_residual", "involute of the pin angle less what it must be, zero at it", "rad", "f")
odd_teeth = Quantity("odd_teeth", "1 for an odd number of teeth, 0 for an even one", "1", "o", (0, 1), values=(0, 1))
over_pins = _length("over_pins", "M", 0.0, 1e5, "measurement over two pins")
pin_contact_length = _length(
    "pin_contact_length", "2 l_p", -1e5, 1e5, "twice the length of the generating line at the contact of the pin"
)
pin_contact_diameter = _length("pin_contact_diameter", "d_p'", 0.0, 1e5, "diameter at which the pin touches")
feed_counts = Quantity("feed_counts", "counts of the feed encoder per mm", "1/mm", "C", (1.0, 10_000.0))
hob_ratio = Quantity("hob_ratio", "motor steps per count of the hob, signed", "1", r"\kappa_h", scale=1e3)
feed_ratio = Quantity("feed_ratio", "motor steps per count of the feed, signed", "1", r"\kappa_z", scale=1e6)
common_denominator = _count("common_denominator", "D", 1, 2**40, "denominator of both ratios")
travel = _length("travel", "Z", 0.0, 1000.0, "travel of the feed")
feed_bound = Quantity(
    "feed_bound", "largest error of the position from rounding the ratio of the feed", "steps", r"\epsilon", scale=1e3
)
feed_per_turn = _length("feed_per_turn", "f", 0.01, 10.0, "feed per turn of the table")
cut_sign = Quantity("cut_sign", "+1 climb, -1 conventional hobbing", "1", "c", (-1, 1), values=(-1, 1))
fed_ratio = Quantity(
    "fed_ratio", "motor steps per count of the hob at a constant feed, signed", "1", r"\kappa_f", scale=1e3
)
thread_pitch = _length("thread_pitch", "P", 0.01, 100.0, "pitch of the thread to be cut")
thread_starts = _count("thread_starts", "k", 1, 10, "starts of the thread")
thread_sign = Quantity("thread_sign", "+1 right-hand, -1 left-hand thread", "1", "s_t", (-1, 1), values=(-1, 1))
lead_screw_pitch = _length("lead_screw_pitch", "P_L", 0.01, 100.0, "travel of the carriage per turn of the lead screw")
lead_screw_ratio = Quantity(
    "lead_screw_ratio", "motor steps per count of the spindle, signed", "1", r"\kappa_t", scale=1e6
)

# --- virtual hobbing --------------------------------------------------------------------------------------------
flank_side = Quantity(
    "flank_side",
    "+1 the flank that bounds a space towards growing angles, right seen from +z; -1 the other",
    "1",
    r"\sigma",
    (-1, 1),
    values=(-1, 1),
)
edge_height = _length(
    "edge_height", "h_e", -30.0, 30.0, "height of a point of an edge above the hob's reference cylinder"
)
edge_relief = _length("edge_relief", "w_e", -10.0, 30.0, "how far an edge is inside the thread, along the hob's axis")
hob_turn = _angle("hob_turn", r"\tau", -0.6, 0.6, "turn of a gash past the common perpendicular")
thread_angle = _angle("thread_angle", r"\vartheta", -7.0, 7.0, "where the thread stands, as a turn of the hob")
gash_twist = Quantity("gash_twist", "turn of a gash per length along the hob", "rad/mm", r"\kappa_i", (-0.02, 0.02))
gash_thread = _angle("gash_thread", r"\vartheta_0", -7.0, 7.0, "where the thread stands in the gash's middle section")
edge_along_hob = _length("edge_along_hob", "y_e", -1e3, 1e3, "where an edge stands along the hob's axis")
hob_feed = Quantity("hob_feed", "travel of the hob along the gear per radian of its turn", "mm/rad", "v", (-0.5, 0.5))
table_error = _angle("table_error", r"\Delta\varphi", -0.1, 0.1, "table angle beyond that of ideal meshing")
tool_displacement = _vector(
    "tool_displacement", r"\mathbf{D}", "mm", 1.0, 1.0, "displacement of the hob against the gear, machine frame"
)
roll_length = _length("roll_length", "L", 0.1, 5000.0, "length of roll of a flank's point, from the base cylinder")
cut_radius = _length("cut_radius", r"\rho", 0.0, 1e4, "radius at which an edge cuts")
cut_angle = Quantity("cut_angle", "angle at which it cuts, from the middle of the space", "rad", r"\theta", scale=1e1)
cut_height = Quantity("cut_height", "height at which it cuts, from the hob", "mm", r"P_z", scale=1e3)
roll_foot = _length("roll_foot", "L_0", 0.0, 1e5, "length of roll of the flank's point that is cut")
height_foot = Quantity("height_foot", "its height on the gear, from the hob", "mm", "z_0", scale=1e3)
cut_deviation = Quantity(
    "cut_deviation", "what the edge leaves on the flank, along its normal", "mm", r"\delta_e", scale=1e3
)
contact_height = Quantity("contact_height", "where hob and flank touch, from the hob", "mm", "z_c", scale=1e3)
contact_edge = Quantity("contact_edge", "height of the hob's edge there", "mm", "h_c", scale=1e3)
contact_turn = Quantity("contact_turn", "turn of the hob there, from the common perpendicular", "rad", r"\tau_c")
contact_thread = Quantity("contact_thread", "where the thread stands then", "rad", r"\vartheta_c", scale=1e2)
hob_axial_pitch = _length("hob_axial_pitch", "p_{x0}", 0.0, 1e3, "pitch of a hob's teeth along its axis")
hob_addendum = _length("hob_addendum", "h_{a0}", 0.1, 60.0, "height of a hob's tooth above its reference cylinder")
hob_tip_radius = _length(
    "hob_tip_radius", r"\rho_{a0}", 0.0, 12.0, "radius of the rounding at the tip of a hob's tooth"
)
tip_turn = _angle("tip_turn", r"\gamma", 0.15, pi / 2, "direction of the normal of the rounding, from the hob's axis")
rounding_height = Quantity("rounding_height", "height of a point of the rounding", "mm", "h_r", scale=1e2)
tip_relief = Quantity("tip_relief", "how far it is inside the thread, along the hob's axis", "mm", "w_r", scale=1e2)
protuberance = _length(
    "protuberance", "p_{r0}", 0.0, 3.0, "how far the tip of a hob's tooth protrudes beyond its flank, along the normal"
)
protuberance_angle = _angle("protuberance_angle", r"\alpha_{pr}", 0.0, 0.5, "pressure angle of the protruding flank")
hob_dedendum = _length(
    "hob_dedendum", "h_{f0}", 0.1, 60.0, "depth of a topping hob's root below its reference cylinder"
)
topped_radius = _length("topped_radius", r"\rho_a", 0.0, 1e4, "radius of the tip that a topping hob leaves")
tip_facet = Quantity(
    "tip_facet", "height of the ridges between facets of a topped tip", "mm", r"\delta_{ya}", scale=1e1
)
tip_feed_mark = Quantity("tip_feed_mark", "height of the ridges of the feed on it", "mm", r"\delta_{xa}", scale=1e1)
form_height = Quantity("form_height", "height up to which the edge is straight", "mm", "h_F", scale=1e2)
land_half_width = Quantity("land_half_width", "half the land between both roundings", "mm", "w_a", scale=1e2)
hob_gashes = _count("hob_gashes", "n_i", 4, 40, "gashes of a hob")
flat_height = Quantity("flat_height", "height of the ridges between flats", "mm", r"\delta_y", scale=1e1)
feed_mark_height = Quantity("feed_mark_height", "height of the ridges between feed marks", "mm", r"\delta_x", scale=1e1)
least_teeth = Quantity("least_teeth", "teeth below which a flank is undercut", "1", r"z_{min}", scale=1e3)
hob_shift = _vector("hob_shift", r"\mathbf{e}_0", "mm", 1.0, 1.0, "shift of the hob: towards gear, up, along its axis")
feed_shift = _length("feed_shift", r"\Delta z", -1.0, 1.0, "error of the travel along the gear")
blank_shift = Quantity(
    "blank_shift", "offset of the gear's axis from the table's, x and y", "mm", r"\mathbf{e}_2", (-1.0, 1.0), (2,)
)
blank_tilt = Quantity(
    "blank_tilt", "tilt of the gear's axis, about x and y", "rad", r"\boldsymbol{\omega}", (-0.01, 0.01), (2,)
)
cut_place = _vector("cut_place", r"\mathbf{P}", "mm", 1e4, 5e3, "where it cuts, from the middle of the blank's seat")
displacement = _vector("displacement", r"\mathbf{D}'", "mm", 1e2, 1e3, "displacement of the hob against the gear")
right_deviation = _length("right_deviation", r"\delta_R", -1.0, 1.0, "deviation of a space's right flank")
left_deviation = _length("left_deviation", r"\delta_L", -1.0, 1.0, "deviation of a space's left flank")
circle_angle = _angle("circle_angle", r"\alpha_{yt}", 0.1, 1.2, "transverse pressure angle where it is measured")
right_position = Quantity("right_position", "where the right flank stands along the circle", "mm", "s_R", scale=1.0)
left_position = Quantity("left_position", "where the left flank stands along the circle", "mm", "s_L", scale=1.0)
accuracy_class = _count("accuracy_class", "A", 1, 11, "flank tolerance class of ISO 1328-1")
gear_face_width = _length("gear_face_width", "b_2", 1.0, 1200.0, "face width of a cylindrical gear")
profile_slope_tolerance = Quantity("profile_slope_tolerance", "allowed slope", "um", r"f_{H\alpha T}", scale=100.0)
profile_form_tolerance = Quantity("profile_form_tolerance", "allowed form", "um", r"f_{f\alpha T}", scale=100.0)
profile_tolerance = Quantity("profile_tolerance", "allowed profile deviation", "um", r"F_{\alpha T}", scale=100.0)
helix_slope_tolerance = Quantity("helix_slope_tolerance", "allowed slope", "um", r"f_{H\beta T}", scale=100.0)
helix_form_tolerance = Quantity("helix_form_tolerance", "allowed form", "um", r"f_{f\beta T}", scale=100.0)
helix_tolerance = Quantity("helix_tolerance", "allowed helix deviation", "um", r"F_{\beta T}", scale=100.0)
flank_height = _length("flank_height", "z_f", -250.0, 250.0, "height of a point of a flank on the gear")
space_index = _count("space_index", "i", -999, 999, "which space of the gear a flank bounds")
gear_flank_point = _vector("gear_flank_point", r"\mathbf{p}", "mm", 1e4, 1e5, "point of a cylindrical gear's flank")
gear_flank_normal = _vector("gear_flank_normal", r"\mathbf{n}_f", "1", 1.0, 1.0, "normal there, out of the metal")
harmonic_turn = _angle("harmonic_turn", "u", -1e3, 1e3, "how far a part has turned")
harmonic_amplitude = Quantity("harmonic_amplitude", "amplitude of a sine, in its unit", "1", "A", (0.0, 100.0))
harmonic_order = _count("harmonic_order", "n", 1, 1000, "how many periods it has in a turn")
harmonic_phase = _angle("harmonic_phase", r"\chi_0", -7.0, 7.0, "its phase at the start")
harmonic_value = Quantity("harmonic_value", "value of the sine", "1", r"A_n", scale=1e6)
ball_height = Quantity("ball_height", "how far a ball in a space stands out", "mm", r"\Delta r", scale=1.0)

# --- bevel blank ------------------------------------------------------------------------------------------------
pitch_angle = _angle("pitch_angle", r"\delta", 0.1, 1.5, "pitch cone against the member's axis")
face_angle = _angle("face_angle", r"\delta_a", 0.1, 1.57, "face cone against the member's axis")
root_angle = _angle("root_angle", r"\delta_f", 0.05, 1.5, "root cone against the member's axis")
mean_cone_distance = _length("mean_cone_distance", "R_m", 10.0, 400.0, "apex to mean point along the pitch cone")
face_width = _length("face_width", "b", 2.0, 100.0, "length of the teeth along the pitch cone")
mean_addendum = _length("mean_addendum", "h_{am}", 0.2, 20.0, "tooth height above the pitch cone at the mean point")
mean_dedendum = _length("mean_dedendum", "h_{fm}", 0.2, 20.0, "tooth depth below the pitch cone at the mean point")
clearance = _length("clearance", "c", 0.0, 5.0, "depth of the root that the mating tooth does not reach")
blank = Quantity(
    "blank",
    "blank of one member, pitch apex in the crossing point",
    "mixed",
    r"\mathbf{b}",
    shape=(8,),
    components=(
        pitch_angle,
        face_angle,
        root_angle,
        mean_cone_distance,
        face_width,
        mean_addendum,
        mean_dedendum,
        clearance,
    ),
)
across = Quantity("across", "place along the tooth: 0 toe, 1 heel", "1", r"\xi", (0.0, 1.0))
up = Quantity("up", "place up the working depth: 0 lower limit, 1 tip", "1", r"\eta", (0.0, 1.0))
axial = Quantity("axial", "coordinate z_w of a flank point", "mm", "z_w", (5.0, 300.0), scale=300.0)
radial = Quantity("radial", "distance of a flank point from the member's axis", "mm", "r_w", (5.0, 300.0), scale=300.0)
across_space = Quantity("across_space", "outward normal of a flank, its part around the axis", "1", r"n_\varphi")
flank_azimuth = _angle("flank_azimuth", r"\varphi", -3.2, 3.2, "direction of a flank point about z_w")
contact = Quantity(
    "contact",
    "surface parameters u, beta, theta of a flank point",
    "mixed",
    r"(u, \beta, \theta)",
    shape=(3,),
    components=(u, beta, theta),
    scale=100.0,
)
turning = Quantity(
    "turning", "angle by which a flank is turned about z_w to leave this deviation", "rad", r"\varepsilon", scale=1.0
)
arc = Quantity("arc", "the same as an arc at the radius of the point", "mm", "s", scale=300.0)
deviation_in = Quantity("deviation_in", "measured deviation along the outward normal", "mm", r"\delta", (-0.5, 0.5))

# --- every motion and every blade -------------------------------------------------------------------------------
motion = Quantity(
    "motion",
    "coefficients of theta^1 ... theta^7 (columns) of the machine settings (rows, in their order)",
    "mixed",
    "m",
    (-0.3, 0.3),
    shape=(10, 7),
)
settings_at = Quantity(
    "settings_at",
    "machine and cutter settings of one flank at a cradle rotation",
    "mixed",
    r"\mathbf{x}(\theta)",
    shape=(12,),
    scale=100.0,
)
index_ratio = Quantity(
    "index_ratio",
    "work rotation per cutter rotation, blade groups over teeth; 0 in face milling",
    "1",
    r"\iota",
    (-0.8, 0.8),
)
blade_offset_angle = _angle("blade_offset_angle", r"\eta", -0.5, 0.5, "turn of the blade's plane about its point")
arc_angle = _angle("arc_angle", "u", 0.05, 1.5, "angle of the blade's normal against the tip plane, on an arc blade")
blade_arc = Quantity(
    "blade_arc",
    "arc blade: radius and height of its centre, and its radius (positive = convex blade)",
    "mm",
    r"\mathbf{a}",
    shape=(3,),
    components=(
        _length("arc_center_radius", r"\rho_b", 20.0, 250.0, "distance of the arc's centre from the cutter axis"),
        _length("arc_center_height", "h_b", -50.0, 50.0, "height of the arc's centre above the tip plane"),
        _length("arc_radius", "r", 0.2, 15.0, "radius of the arc"),
    ),
)
touching_point_radius = Quantity(
    "touching_point_radius", "point radius of the straight blade that touches an arc blade", "mm", "r_{pt}", scale=1e4
)
touching_pressure_angle = _angle(
    "touching_pressure_angle", r"\alpha_t'", 0.0, 1.57, "its angle against the cutter axis"
)
main_arc = Quantity(
    "main_arc",
    "arc of a circular-arc blade: radius and height of its centre, and its radius",
    "mm",
    r"\mathbf{a}_r",
    shape=(3,),
    components=(
        _length("main_center_radius", r"\rho_b", -700.0, 900.0, "distance of the arc's centre from the cutter axis"),
        _length("main_center_height", "h_b", -50.0, 300.0, "height of the arc's centre above the tip plane"),
        _length("main_radius", "r", 200.0, 800.0, "radius of the arc, positive where the blade is convex"),
    ),
)
straight_edge = Quantity(
    "straight_edge",
    "straight part of a blade's edge: radius and height at u = 0, and what u adds to them",
    "mixed",
    r"\mathbf{l}",
    shape=(4,),
    components=(
        _length("edge_start_radius", r"\rho_0", 20.0, 250.0, "radius of the edge about the cutter axis at u = 0"),
        _length("edge_start_height", "h_0", 0.0, 15.0, "height of the edge above the tip plane at u = 0"),
        Quantity("edge_radial_slope", "growth of the radius with u", "1", r"\rho'", (-1.0, 1.0)),
        Quantity("edge_height_slope", "growth of the height with u", "1", "h'", (0.0, 1.0)),
    ),
)
edge_point_w = _vector("edge_point_w", r"\mathbf{R}_e", "mm", 300.0, 1000.0, "point of a blade's edge, work frame w")
approach_curvature = Quantity(
    "approach_curvature",
    "second derivative of the distance of a blade from a flank point by the roll at its contact",
    "mm/rad2",
    "c",
    (0.1, 1e5),
)
scallop = _length("scallop", r"\delta", 1e-6, 0.1, "height of what is left between two passes of a blade")
roll_per_turn = Quantity("roll_per_turn", "cradle rotation per turn of the work", "rad", r"\Delta\theta")
toprem_angle = _angle("toprem_angle", r"\alpha_T", 0.01, 0.6, "angle between the Toprem section and the cutter axis")
toprem_height = _length("toprem_height", "h_T", 0.0, 5.0, "height above the tip plane at which Toprem ends")
toprem_point_radius = _length(
    "toprem_point_radius", "r_{pT}", 20.0, 250.0, "radius at which Toprem meets the tip plane"
)
blade_spheric_radius = _length("blade_spheric_radius", "r", 200.0, 2000.0, "radius of a circular-arc blade")
blade_curvature = Quantity(
    "blade_curvature",
    "curvature of a blade's edge: one over its radius, zero where it is straight",
    "1/mm",
    r"\kappa",
    (-0.01, 0.01),
)
reference_height = _length("reference_height", "h_r", 0.0, 15.0, "height at which arc and straight blade touch")
blade_edge_radius = _length("blade_edge_radius", "r_e", 0.1, 3.0, "radius of the rounded blade edge")
blade_tip_radius = _length("blade_tip_radius", "r_t", 20.0, 250.0, "radius of the blade at its tip")
blade_tip_height = _length(
    "blade_tip_height", "h_t", -2.0, 2.0, "height of the blade's tip above the plane of its point radius"
)
joint_height = _length("joint_height", "h_j", 0.0, 5.0, "height above the tip plane at which edge and blade join")
joint_angle = _angle("joint_angle", r"u_j", 0.0, 1.5, "angle of the normal at which edge and arc blade join")
roll_coefficients = Quantity(
    "roll_coefficients",
    "modified roll 2C, 6D, 24E, 120F",
    "1",
    "(2C, 6D, 24E, 120F)",
    (-50.0, 50.0),
    shape=(4,),
)
roll_motion = Quantity(
    "roll_motion",
    "coefficients of theta^1 ... theta^7 of the work rotation offset",
    "rad",
    r"m_{\varphi}",
    shape=(7,),
    scale=100.0,
)

# --- bevel blank to ISO 23509 -----------------------------------------------------------------------------------
shaft_angle = _angle("shaft_angle", r"\Sigma", 0.6, 2.4, "angle between the axes of the pair")
pinion_teeth = _count("pinion_teeth", "z_1", 5, 60, "teeth of the pinion")
wheel_teeth = _count("wheel_teeth", "z_2", 10, 200, "teeth of the wheel")
gear_ratio = _factor("gear_ratio", "u", 0.1, 40.0, "teeth of the wheel over teeth of the pinion")
outer_transverse_module = _length("outer_transverse_module", "m_{et}", 0.3, 30.0, "module at the heel, across the axis")
wheel_outer_pitch_diameter = _length("wheel_outer_pitch_diameter", "d_{e2}", 20.0, 1000.0, "pitch circle at the heel")
mean_spiral_angle = _angle("mean_spiral_angle", r"\beta_m", 0.0, 0.9, "tooth trace against the cone line at mean point")
spiral_angle = _angle("spiral_angle", r"\beta", -0.8, 1.3, "tooth trace against the cone line, at a cone distance")
pinion_pitch_angle = _angle("pinion_pitch_angle", r"\delta_1", 0.1, 1.2, "pitch cone of the pinion against its axis")
wheel_pitch_angle = _angle("wheel_pitch_angle", r"\delta_2", 0.4, 1.5, "pitch cone of the wheel against its axis")
cone_distance = _length("cone_distance", "R", 10.0, 400.0, "apex to a place along the pitch cone")
outer_cone_distance = _length("outer_cone_distance", "R_e", 10.0, 500.0, "apex to heel along the pitch cone")
inner_cone_distance = _length("inner_cone_distance", "R_i", 5.0, 400.0, "apex to toe along the pitch cone")
mean_normal_module = _length("mean_normal_module", "m_{mn}", 0.3, 20.0, "module across the tooth at the mean point")
cutter_radius = _length("cutter_radius", "r_{c0}", 20.0, 250.0, "mean radius of the cutter, at the pitch plane")
blade_groups = _count("blade_groups", "z_0", 1, 30, "blade groups of a face hobbing cutter")
cutter_lead_angle = _angle("cutter_lead_angle", r"\nu", 0.0, 1.4, "lead of the blade against the circle it stands on")
cutter_center_distance = _length(
    "cutter_center_distance", r"\rho_{P0}", 10.0, 500.0, "axis of the crown gear to the axis of the cutter"
)
epicycloid_base_radius = _length("epicycloid_base_radius", r"\rho_b", 5.0, 400.0, "base circle of the epicycloid")
pressure_angle_drive = _angle("pressure_angle_drive", r"\alpha_{nD}", 0.2, 0.5, "normal angle of the drive side")
pressure_angle_coast = _angle("pressure_angle_coast", r"\alpha_{nC}", 0.2, 0.5, "normal angle of the coast side")
mean_normal_pressure_angle = _angle("mean_normal_pressure_angle", r"\alpha_n", 0.2, 0.5, "mean of drive and coast side")
mean_addendum_factor = _factor("mean_addendum_factor", "c_{ham}", 0.05, 0.6, "wheel mean addendum over working depth")
tooth_depth_factor = _factor("tooth_depth_factor", "k_d", 1.5, 2.4, "mean working depth in mean normal modules")
clearance_factor = _factor("clearance_factor", "k_c", 0.05, 0.3, "clearance over mean working depth")
thickness_factor = _factor("thickness_factor", "k_t", -0.4, 0.4, "thickness exchanged between the members, in modules")
crown_gear_addendum_factor = _factor("crown_gear_addendum_factor", "k_{hap}", 0.7, 1.2, "basic crown gear addendum")
crown_gear_dedendum_factor = _factor("crown_gear_dedendum_factor", "k_{hfp}", 0.9, 1.6, "basic crown gear dedendum")
profile_shift_coefficient = _factor("profile_shift_coefficient", "x_{hm1}", -0.2, 0.8, "profile shift of the pinion")
thickness_modification = _factor(
    "thickness_modification", "x_{smn}", -0.2, 0.2, "thickness modification of the pinion without backlash"
)
mean_working_depth = _length("mean_working_depth", "h_{mw}", 0.4, 50.0, "depth in which the teeth touch, at mean point")
mean_whole_depth = _length("mean_whole_depth", "h_m", 0.4, 60.0, "mean addendum and dedendum of one member")
pinion_mean_addendum = _length("pinion_mean_addendum", "h_{am1}", 0.2, 20.0, "pinion tooth above the pitch cone")
pinion_mean_dedendum = _length("pinion_mean_dedendum", "h_{fm1}", 0.2, 20.0, "pinion tooth below the pitch cone")
wheel_mean_addendum = _length("wheel_mean_addendum", "h_{am2}", 0.2, 20.0, "wheel tooth above the pitch cone")
wheel_mean_dedendum = _length("wheel_mean_dedendum", "h_{fm2}", 0.2, 20.0, "wheel tooth below the pitch cone")
depth_taper = Quantity(
    "depth_taper",
    "0 uniform depth, 1 standard, 2 duplex (constant slot width), 3 tilted root line",
    "1",
    "T",
    (0, 3),
    kind="int",
    values=(0, 1, 2, 3),
)
dedendum_angle_sum = _angle("dedendum_angle_sum", r"\Sigma\theta_f", -1.0, 1.0, "dedendum angles of both members")
pinion_addendum_angle = _angle("pinion_addendum_angle", r"\theta_{a1}", 0.0, 0.2, "pinion face cone against pitch cone")
pinion_dedendum_angle = _angle("pinion_dedendum_angle", r"\theta_{f1}", 0.0, 0.2, "pinion root against pitch cone")
wheel_addendum_angle = _angle("wheel_addendum_angle", r"\theta_{a2}", 0.0, 0.2, "wheel face cone against pitch cone")
wheel_dedendum_angle = _angle("wheel_dedendum_angle", r"\theta_{f2}", 0.0, 0.2, "wheel root cone against pitch cone")
pinion_face_angle = _angle("pinion_face_angle", r"\delta_{a1}", 0.1, 1.57, "face cone of the pinion against its axis")
pinion_root_angle = _angle("pinion_root_angle", r"\delta_{f1}", 0.05, 1.5, "root cone of the pinion against its axis")
wheel_face_angle = _angle("wheel_face_angle", r"\delta_{a2}", 0.1, 1.57, "face cone of the wheel against its axis")
wheel_root_angle = _angle("wheel_root_angle", r"\delta_{f2}", 0.05, 1.5, "root cone of the wheel against its axis")
pinion_face_apex = _length("pinion_face_apex", "t_{zF1}", -100.0, 50.0, "pinion face apex beyond the crossing point")
pinion_root_apex = _length("pinion_root_apex", "t_{zR1}", -50.0, 100.0, "pinion root apex beyond the crossing point")
wheel_face_apex = _length("wheel_face_apex", "t_{zF2}", -100.0, 50.0, "wheel face apex beyond the crossing point")
wheel_root_apex = _length("wheel_root_apex", "t_{zR2}", -50.0, 100.0, "wheel root apex beyond the crossing point")
outer_addendum = _length("outer_addendum", "h_{ae}", 0.0, 30.0, "tooth above the pitch cone at the heel")
outer_dedendum = _length("outer_dedendum", "h_{fe}", 0.0, 30.0, "tooth below the pitch cone at the heel")
outer_whole_depth = _length("outer_whole_depth", "h_e", 0.0, 60.0, "depth of the tooth at the heel")
inner_addendum = _length("inner_addendum", "h_{ai}", 0.0, 30.0, "tooth above the pitch cone at the toe")
inner_dedendum = _length("inner_dedendum", "h_{fi}", 0.0, 30.0, "tooth below the pitch cone at the toe")
inner_whole_depth = _length("inner_whole_depth", "h_i", 0.0, 60.0, "depth of the tooth at the toe")
outer_pitch_diameter = _length("outer_pitch_diameter", "d_e", 5.0, 1000.0, "pitch circle at the heel")
mean_pitch_diameter = _length("mean_pitch_diameter", "d_m", 5.0, 900.0, "pitch circle at the mean point")
inner_pitch_diameter = _length("inner_pitch_diameter", "d_i", 5.0, 800.0, "pitch circle at the toe")
outer_tip_diameter = _length("outer_tip_diameter", "d_{ae}", 5.0, 1000.0, "outside diameter of the crown")
outer_root_diameter = _length("outer_root_diameter", "d_{fe}", 5.0, 1000.0, "root circle at the heel")
inner_tip_diameter = _length("inner_tip_diameter", "d_{ai}", 5.0, 800.0, "tip circle at the toe")
inner_root_diameter = _length("inner_root_diameter", "d_{fi}", 5.0, 800.0, "root circle at the toe")
crossing_point_to_mean_point = _length("crossing_point_to_mean_point", "t_{zm}", 0.0, 500.0, "distance along the axis")
crossing_point_to_crown = _length("crossing_point_to_crown", "t_{xo}", 0.0, 500.0, "along the axis to the crown")
crossing_point_to_front_crown = _length(
    "crossing_point_to_front_crown", "t_{xi}", 0.0, 500.0, "distance along the axis to the tip at the toe"
)
pinion_root_normal_depth = _length(
    "pinion_root_normal_depth", "h_{t1}", 0.0, 60.0, "whole depth of the pinion at the crown, square to its root cone"
)
backlash = _length("backlash", "j", 0.0, 1.0, "backlash of the pair, of the kind that backlash_kind says")
backlash_kind = Quantity(
    "backlash_kind",
    "0 outer normal, 1 outer transverse, 2 mean normal, 3 mean transverse",
    "1",
    "K",
    (0, 3),
    kind="int",
    values=(0, 1, 2, 3),
)
outer_normal_backlash = _length("outer_normal_backlash", "j_{en}", 0.0, 2.0, "square to the flank, at the heel")
outer_transverse_backlash = _length("outer_transverse_backlash", "j_{et}", 0.0, 2.0, "backlash as an arc, at the heel")
mean_normal_backlash = _length("mean_normal_backlash", "j_{mn}", 0.0, 2.0, "backlash square to the flank, mean point")
mean_transverse_backlash = _length("mean_transverse_backlash", "j_{mt}", 0.0, 2.0, "backlash as an arc, mean point")
pinion_thickness_coefficient = _factor("pinion_thickness_coefficient", "x_{sm1}", -0.3, 0.3, "with backlash")
wheel_thickness_coefficient = _factor("wheel_thickness_coefficient", "x_{sm2}", -0.3, 0.3, "with backlash")
pinion_mean_normal_thickness = _length("pinion_mean_normal_thickness", "s_{mn1}", 0.2, 40.0, "arc across the tooth")
wheel_mean_normal_thickness = _length("wheel_mean_normal_thickness", "s_{mn2}", 0.2, 40.0, "arc across the tooth")
mean_normal_thickness = _length("mean_normal_thickness", "s_{mn}", 0.2, 40.0, "arc across the tooth at the mean point")
mean_transverse_thickness = _length("mean_transverse_thickness", "s_{mt}", 0.2, 60.0, "arc in the plane of rotation")
mean_normal_diameter = _length("mean_normal_diameter", "d_{mn}", 5.0, 1e4, "pitch circle of the normal section")
mean_normal_chordal_thickness = _length("mean_normal_chordal_thickness", "s_{mnc}", 0.2, 40.0, "chord across the tooth")
mean_chordal_addendum = _length("mean_chordal_addendum", "h_{amc}", 0.2, 40.0, "tip above the chord of the thickness")

# --- slot width, top land and edge radius to AGMA 929 -----------------------------------------------------------
slot_rotation_factor = _factor(
    "slot_rotation_factor", "k_E", 0.0, 1.3, "half pitches by which the work turns from blade to blade; 0 spread blade"
)
normal_pitch = _length("normal_pitch", "p_n", 0.5, 100.0, "pitch across the tooth at the mean point")
normal_backlash = _length("normal_backlash", "j_n", -5.0, 5.0, "backlash square to the flank, at a cone distance")
clearance_change = _length("clearance_change", r"\Delta c", 0.0, 2.0, "approach of the teeth that uses up the backlash")
pinion_slot_width = _length("pinion_slot_width", "W_1", 0.0, 50.0, "width of the slot at the pinion's root")
wheel_slot_width = _length("wheel_slot_width", "W_2", 0.0, 50.0, "width of the slot at the wheel's root")
pinion_normal_thickness = _length("pinion_normal_thickness", "s_{n1}", 0.0, 50.0, "arc across the tooth, any place")
wheel_normal_thickness = _length("wheel_normal_thickness", "s_{n2}", 0.0, 50.0, "arc across the tooth, any place")
involute_cone_distance = _length("involute_cone_distance", "R_x", 0.0, 500.0, "where the normal pitch is greatest")
virtual_pitch_radius = _length("virtual_pitch_radius", "r_{np}", 5.0, 1500.0, "pitch circle of the virtual spur gear")
mate_virtual_pitch_radius = _length("mate_virtual_pitch_radius", "r'_{np}", 5.0, 1500.0, "the same of the mate")
addendum_here = _length("addendum_here", "h_a", 0.0, 20.0, "tooth above the pitch cone at a cone distance")
dedendum_here = _length("dedendum_here", "h_f", 0.0, 20.0, "tooth below the pitch cone at a cone distance")
mate_addendum_here = _length("mate_addendum_here", "h'_a", 0.0, 20.0, "the mate's tooth above its pitch cone")
normal_thickness = _length("normal_thickness", "s_n", 0.2, 40.0, "arc across the tooth at a cone distance")
top_land = _length("top_land", "s_{an}", -10.0, 30.0, "width of the tip across the tooth; negative where it is pointed")
flank_pressure_angle = _angle("flank_pressure_angle", r"\alpha", 0.2, 0.5, "normal pressure angle of one flank")
interference_height = _length(
    "interference_height", "h_{inf}", -20.0, 30.0, "root to the lowest point that the mate's tip reaches, on the blade"
)
edge_radius_interference = _length("edge_radius_interference", "r_{a01}", -30.0, 50.0, "largest that the mate clears")
minimum_slot_width = _length("minimum_slot_width", "W_{min}", 0.3, 30.0, "narrowest place of the slot along the tooth")
blade_flat = _length("blade_flat", r"\Delta_f", 0.0, 2.0, "flat that the edge radius leaves on the blade's tip")
mutilation = _length("mutilation", "y", 0.001, 0.5, "depth of the fillet that the opposite blade may cut away")
blade_point_width = _length("blade_point_width", "W_B", 0.0, 30.0, "width of the blade's tip")
edge_radius_fillet = _length("edge_radius_fillet", "r_{a02}", 0.0, 50.0, "largest that the blade's tip has room for")
edge_radius_mutilation = _length("edge_radius_mutilation", "r_{a03}", 0.0, 100.0, "largest without mutilation")

# --- crown gear -------------------------------------------------------------------------------------------------
hand_sign = Quantity("hand_sign", "+1 right-hand, -1 left-hand member", "1", r"s_h'", (-1, 1), values=(-1, 1))
tilt_direction = _angle("tilt_direction", r"\chi", -1.5, 1.5, "swivel and cradle angle together, right-hand member")
space_width = _length("space_width", "w", 0.0, 40.0, "normal width of the tooth space at the mean point")
wall_angle = _angle("wall_angle", r"\omega", -0.3, 0.3, "how far the middle of the space leans from the cutter's axis")

# --- compensation -----------------------------------------------------------------------------------------------
setting_rates = Quantity(
    "setting_rates",
    "shift of a flank along a line per unit of every setting",
    "mixed",
    r"\partial t/\partial\mathbf{x}",
    (-300.0, 300.0),
    shape=(12,),
    scale=1000.0,
)
motion_rates = Quantity(
    "motion_rates",
    "shift of a flank along a line per unit of every coefficient of the motion",
    "mixed",
    r"\partial t/\partial m",
    shape=(10, 7),
    scale=1000.0,
)
curved_rates = Quantity(
    "curved_rates",
    "shift of a flank along a line per unit of every setting, and of the curvature of the blade",
    "mixed",
    r"\partial t/\partial(\mathbf{x}, \kappa)",
    shape=(13,),
    scale=1000.0,
)
curved_height = Quantity("curved_height", "height of a point of a curved blade above the tip plane", "mm", "h_u")
cone_place = _length("cone_place", "L", -500.0, 500.0, "cone distance of a point, along the pitch cone")
cone_depth = _length("cone_depth", "D", -500.0, 500.0, "depth of a point below the pitch cone")
mate_ratio = _factor("mate_ratio", "z_m/z", 0.1, 10.0, "teeth of the mate over teeth of the member")
meeting_angle = _angle("meeting_angle", r"\psi", -6.3, 6.3, "rotation at which a point of a flank meets the mate")
mate_axial = _length("mate_axial", "z_m", -500.0, 500.0, "coordinate of that point along the axis of the mate")
mate_radial = _length("mate_radial", "r_m", 0.0, 500.0, "distance of that point from the axis of the mate")

# --- ease-off ---------------------------------------------------------------------------------------------------
conjugate_azimuth = Quantity("conjugate_azimuth", "azimuth of the conjugate point on the member", "rad", r"\chi")
gap_turn = _angle("gap_turn", r"\Delta\chi", -0.3, 0.3, "turn of a flank about its axis up to the conjugate one")
ease_off = Quantity("ease_off", "gap between a flank and the conjugate one along its normal", "mm", "E", scale=1.0)

# --- chip -------------------------------------------------------------------------------------------------------
cutter_rpm = Quantity("cutter_rpm", "turns of the cutter in a minute", "1/min", "n", (1.0, 5000.0))
blades_per_turn = Quantity(
    "blades_per_turn", "blades that pass one place of a flank in a turn of the cutter", "1", "N", (0.01, 100.0)
)
blade_period = Quantity("blade_period", "time from one blade to the next", "s", "T_b", (1e-4, 100.0))
passing_speed = Quantity(
    "passing_speed",
    "speed of the work past the cutter: radial, along the cut, along the cutter axis",
    "mm/s",
    r"\mathbf{v}",
    (-100.0, 100.0),
    shape=(3,),
)
blade_advance = Quantity("blade_advance", "advance of the work from one blade to the next", "mm", "f_b", scale=1.0)
chip_thickness = Quantity("chip_thickness", "thickness of the chip, square to the blade", "mm", "h", scale=1.0)
# --- contact of a pair ------------------------------------------------------------------------------------------
pinion_rotation = _angle(
    "pinion_rotation", r"\varphi_1", -pi, pi, "rotation of the pinion, right-handed about its axis"
)
gear_rotation = _angle("gear_rotation", r"\varphi_2", -pi, pi, "rotation of the gear about its axis")
hypoid_offset = _length("hypoid_offset", "a", -50.0, 50.0, "offset of the gear's axis from the pinion's, along Z × X")
assembly = Quantity(
    "assembly",
    "displacements of the members in their assembly",
    "mixed",
    r"\mathbf{m}",
    shape=(4,),
    components=(
        _length("deviation_of_offset", "V", -5.0, 5.0, "gear axis shifted along Y = Z × X"),
        _length("axial_displacement_pinion", "H", -5.0, 5.0, "pinion withdrawn along its axis Z"),
        _length("axial_displacement_gear", "J", -5.0, 5.0, "gear withdrawn along its axis"),
        _angle("deviation_of_shaft_angle", r"\Delta\Sigma", -0.05, 0.05, "growth of the shaft angle"),
    ),
)
pinion_point = _vector("pinion_point", r"\mathbf{r}_1", "mm", 300.0, 300.0, "point of the pinion's flank, pair frame")
pinion_normal = _vector("pinion_normal", r"\mathbf{n}_1", "1", 1.0, 1.0, "its outward unit normal, pair frame")
gear_point = _vector("gear_point", r"\mathbf{r}_2", "mm", 300.0, 300.0, "point of the gear's flank, pair frame")
gear_normal = _vector("gear_normal", r"\mathbf{n}_2", "1", 1.0, 1.0, "its outward unit normal, pair frame")
alignment = Quantity(
    "alignment",
    "parts of the pinion's normal across the gear's, times distances of the contact",
    "mm",
    r"\mathbf{q}",
    shape=(2,),
    scale=1000.0,
)
border = Quantity(
    "border",
    "coefficients of u, z_w, r_w and 1 of a border of a flank",
    "mixed",
    r"\mathbf{c}",
    shape=(4,),
    components=(
        _factor("border_blade", "c_u", -1.0, 1.0, "border: coefficient of the blade's parameter u"),
        _factor("border_axial", "c_z", -1.0, 1.0, "border: coefficient of z_w"),
        _factor("border_radial", "c_r", -1.0, 1.0, "border: coefficient of r_w"),
        _length("border_constant", "c_0", -300.0, 300.0, "border: constant part"),
    ),
)
border_distance = Quantity(
    "border_distance", "distance of a point from a border of its flank, positive inside", "mm", "b", scale=1000.0
)
edge_tangent = _vector("edge_tangent", r"\mathbf{e}", "1", 2.0, 2.0, "direction of the edge at a border, work frame w")
mate_normal = _vector("mate_normal", r"\mathbf{n}'", "1", 1.0, 1.0, "outward unit normal of the mate's flank")
tangency = Quantity("tangency", "part of an edge's direction along the normal of the mate", "1", "t", scale=3.0)
lever = Quantity("lever", "lever of the contact normal about the gear's axis", "mm", r"\rho_2", scale=1000.0)
transmission_slope = Quantity(
    "transmission_slope", "rotation of the gear per rotation of the pinion", "1", r"\varphi_2'", scale=1000.0
)
teeth_ratio = _factor("teeth_ratio", "i", 0.05, 2.0, "teeth of the pinion over teeth of the gear")
apex_beyond = _length(
    "apex_beyond", "t_z'", -20.0, 20.0, "pitch apex of the member beyond the crossing point, seen from the teeth"
)

own_normal = _vector(
    "own_normal", r"\mathbf{n}'", "1", 1.0, 1.0, "outward unit normal of a flank with deviations, work frame w"
)

# --- curvature and local synthesis --------------------------------------------------------------------------------
point_rates = Quantity(
    "point_rates",
    "derivatives of the point of a flank by its three parameters, as columns",
    "mixed",
    r"\mathbf{R}_w",
    (-50.0, 50.0),
    shape=(3, 3),
    scale=1000.0,
)
normal_rates = Quantity(
    "normal_rates",
    "derivatives of the normal of a flank by its three parameters, as columns",
    "mixed",
    r"\mathbf{N}_w",
    (-1.0, 1.0),
    shape=(3, 3),
    scale=100.0,
)
meshing_gradient = Quantity(
    "meshing_gradient",
    "derivatives of the equation of meshing by the three parameters",
    "mixed",
    r"\nabla f",
    (-50.0, 50.0),
    shape=(3,),
    scale=1000.0,
)
first_tangent = _vector(
    "first_tangent", r"\mathbf{t}_1", "1", 1.0, 1.0, "first vector of the basis of the tangent plane"
)
second_tangent = _vector(
    "second_tangent", r"\mathbf{t}_2", "1", 1.0, 1.0, "second vector of the basis of the tangent plane"
)
curvature = Quantity(
    "curvature",
    "shape operator K of a flank, dn = -K dr, in the basis of the tangent plane",
    "1/mm",
    "K",
    (-0.1, 0.1),
    shape=(2, 2),
    scale=1e4,
)
contact_basis = Quantity(
    "contact_basis",
    "orthonormal basis of the tangent plane, as columns",
    "1",
    r"\mathbf{T}",
    (-1.0, 1.0),
    shape=(3, 2),
)
roll_vector = Quantity(
    "roll_vector",
    "how the common normal turns against the gear's flank, in the tangent plane",
    "1",
    r"\mathbf{w}",
    (-3.0, 3.0),
    shape=(2,),
    scale=1e3,
)
roll_acceleration = Quantity(
    "roll_acceleration",
    "normal acceleration of the members against each other, per square of the pinion's speed",
    "mm",
    r"\beta_c",
    (-200.0, 200.0),
    scale=1e5,
)
sliding = Quantity(
    "sliding",
    "velocity of the pinion against the gear in the tangent plane, per speed of the pinion",
    "mm",
    r"\mathbf{v}",
    (-100.0, 100.0),
    shape=(2,),
    scale=1e3,
)
axial_rates = Quantity(
    "axial_rates",
    "how cone distance and height on the gear change along the two tangents",
    "1",
    "M",
    (-1.0, 1.0),
    shape=(2, 2),
)
cone_distance_off = _length("cone_distance_off", r"\xi", -10.0, 10.0, "cone distance on the gear from the vertex")
height_off = _length("height_off", r"\eta_h", -5.0, 5.0, "height on the gear from the vertex")
wanted_length_crowning = _length(
    "wanted_length_crowning", "c_b", 0.002, 0.1, "gap to the conjugate flank that is wanted at toe and heel"
)
wanted_profile_crowning = _length(
    "wanted_profile_crowning", "c_h", 0.002, 0.1, "gap to the conjugate flank that is wanted at root and tip"
)
wanted_bias = _length("wanted_bias", "c_w", -0.002, 0.002, "gap wanted at heel and tip beyond both crownings")
relative_curvature = Quantity(
    "relative_curvature",
    "D = K_1 - K_2: D_11, D_12, D_22",
    "1/mm",
    "D",
    shape=(3,),
    components=(
        Quantity("relative_curvature_11", "relative curvature along the first tangent", "1/mm", "D_{11}", (0.002, 0.1)),
        Quantity("relative_curvature_12", "mixed relative curvature", "1/mm", "D_{12}", (-0.001, 0.001)),
        Quantity("relative_curvature_22", "the same along the second tangent", "1/mm", "D_{22}", (0.002, 0.1)),
    ),
    scale=1e3,
)
lever_arm = _length("lever_arm", r"\rho", 5.0, 200.0, "lever of the contact normal about the gear's axis, given")
contact_velocity = Quantity(
    "contact_velocity",
    "velocity of the contact on the pinion's flank, per speed of the pinion",
    "mm",
    r"\mathbf{v}_1",
    shape=(2,),
    scale=1e5,
)
transmission_curvature = Quantity(
    "transmission_curvature",
    "second derivative of the gear's rotation by the pinion's",
    "rad/rad^2",
    r"\varphi_2''",
    scale=1e5,
)
conjugate_curvature = Quantity(
    "conjugate_curvature",
    "D of the pinion that is conjugate to the gear: D_11, D_12, D_22",
    "1/mm",
    "D_c",
    shape=(3,),
    scale=1e3,
)
separation = _length("separation", r"\tau", 0.001, 0.02, "distance of the flanks at the border of the contact ellipse")
semi_axes = Quantity(
    "semi_axes", "half axes of the contact ellipse, the major one first", "mm", r"(a, b)", shape=(2,), scale=100.0
)
path_angle = _angle("path_angle", r"\eta", 0.2, 1.4, "direction of the path in the basis of the tangent plane")
wanted_curvature = Quantity(
    "wanted_curvature",
    "wanted second derivative of the gear's rotation by the pinion's",
    "rad/rad^2",
    "m'",
    (-0.01, 0.01),
)
major_semi_axis = _length("major_semi_axis", "a_c", 2.0, 20.0, "wanted major half axis of the contact ellipse")
synthesized_curvature = Quantity(
    "synthesized_curvature",
    "D_11, D_12, D_22 that give path, parabola and ellipse as wanted",
    "1/mm",
    "D",
    shape=(3,),
    scale=1e5,
)

# --- design -------------------------------------------------------------------------------------------------------
addendum_constant = _factor("addendum_constant", "k_1", 0.1, 0.3, "part of the addendum factor that no ratio changes")
addendum_share = _factor("addendum_share", "k_2", 0.1, 0.3, "part of the addendum factor over the square of the ratio")
transmission_amplitude = _angle(
    "transmission_amplitude", "A", 0.0, 5e-4, "transmission error wanted half a pitch from the vertex"
)
signed_lever = _length("signed_lever", r"\rho_2", -200.0, 200.0, "lever of the contact normal about the gear's axis")
gear_path_angle = _angle(
    "gear_path_angle", r"\eta_2", 0.2, 2.9, "direction of the path on the gear, from its root line towards the tip"
)
along_tooth = _length("along_tooth", r"\xi", -20.0, 20.0, "place along the tooth, from the mean point")

# --- polynomial blocks --------------------------------------------------------------------------------------------
block_start = Quantity("block_start", "position of an axis at the start of a block", "mixed", "a_0", (-500.0, 500.0))
block_end = Quantity("block_end", "position of an axis at the end of a block", "mixed", "x_e", (-500.0, 500.0))
slope_start = Quantity("slope_start", "its derivative by the parameter at the start", "mixed", "v_0", (-200.0, 200.0))
slope_end = Quantity("slope_end", "its derivative by the parameter at the end", "mixed", "v_1", (-200.0, 200.0))
bend_start = Quantity("bend_start", "its second derivative at the start", "mixed", "w_0", (-200.0, 200.0))
bend_end = Quantity("bend_end", "its second derivative at the end", "mixed", "w_1", (-200.0, 200.0))
block_interval = Quantity(
    "block_interval", "value of the parameter at the end of a block (PL)", "1", "L", (0.5, 10.0), default=1.0
)
cubic_coefficients = Quantity(
    "cubic_coefficients", "a_2, a_3 of a block", "mixed", r"(a_2, a_3)", shape=(2,), scale=1e4
)
quintic_coefficients = Quantity(
    "quintic_coefficients", "a_2 to a_5 of a block", "mixed", r"(a_2 .. a_5)", shape=(4,), scale=1e6
)
axis_slopes = Quantity(
    "axis_slopes",
    "derivatives of X, Y, Z, A, B by the parameter",
    "mixed",
    r"\dot{\mathbf{a}}",
    (-200.0, 200.0),
    shape=(5,),
)
feed_radius_A = _length("feed_radius_A", "r_A", 1.0, 500.0, "radius at which F counts the way of A (FGREF)")
feed_radius_B = _length("feed_radius_B", "r_B", 1.0, 500.0, "radius at which F counts the way of B (FGREF)")
path_rate = Quantity("path_rate", "length of the path per unit of the parameter", "mm", r"ds/dp", scale=1e5)
