"""Every quantity of the house, once: name, meaning, unit, LaTeX, domain.

Names follow ISO 23509, ISO 21771 and REXS (American spelling). Lengths are mm, angles rad. The domains are where the
expressions are valid and where the tests sample them; people's limits belong to the files in ``gearmath.specs``.
"""

from __future__ import annotations

from math import pi

from derivations.expression import Quantity


def _length(name: str, latex: str, low: float, high: float, description: str) -> Quantity:
    return Quantity(name, description, "mm", latex, (low, high), scale=100.0)


def _angle(name: str, latex: str, low: float, high: float, description: str) -> Quantity:
    return Quantity(name, description, "rad", latex, (low, high))


def _vector(name: str, latex: str, unit: str, scale: float, bound: float, description: str) -> Quantity:
    return Quantity(name, description, unit, latex, (-bound, bound), shape=(3,), scale=scale)


def _count(name: str, latex: str, low: int, high: int, description: str) -> Quantity:
    return Quantity(name, description, "1", latex, (low, high), kind="int")


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
machine_root_angle = _angle("machine_root_angle", r"\Gamma", 0.05, 1.45, "work axis against the machine plane")
ratio_of_roll = Quantity(
    "ratio_of_roll", "work rotation per cradle rotation", "1", "R_a", (0.5, 8.0), scale=1.0
)  # fmt: skip
work_rotation_offset = _angle("work_rotation_offset", r"\varphi_0", -pi, pi, "work rotation at cradle rotation zero")

settings = Quantity(
    "settings", "machine and cutter settings of one flank", "mixed", r"\mathbf{x}", shape=(12,),
    components=(
        radial_distance, cradle_angle, cutter_tilt, cutter_swivel, blank_offset, sliding_base,
        machine_center_to_crossing_point, machine_root_angle, ratio_of_roll, work_rotation_offset,
        blade_point_radius, blade_pressure_angle,
    ),
)  # fmt: skip

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
    "meshing_residual", "normal speed of cutter against work per unit of cradle speed, zero in contact",
    "mm/rad", "f", scale=1000.0,
)  # fmt: skip
sensitivity = Quantity(
    "sensitivity", "deviation per unit of every setting at the contact point", "mixed",
    r"\partial\delta/\partial\mathbf{x}", shape=(12,), scale=1000.0,
)  # fmt: skip

# --- vertical machine -------------------------------------------------------------------------------------------
X = Quantity("X", "position of axis X", "mm", "X", (-500.0, 500.0), scale=300.0)
Y = Quantity("Y", "position of axis Y", "mm", "Y", (-500.0, 500.0), scale=300.0)
Z = Quantity("Z", "position of axis Z", "mm", "Z", (-500.0, 900.0), scale=600.0)
A = Quantity(
    "A", "position of the work axis A, right-handed about the work axis", "rad", "A", (-10.0, 10.0), scale=10.0
)
B = Quantity("B", "position of the swivel axis B, left-handed about Y", "rad", "B", (-0.2, 1.7), scale=1.0)
axes = Quantity(
    "axes", "axis positions X, Y, Z, A, B of the vertical machine", "mixed", r"\mathbf{a}", shape=(5,),
    components=(X, Y, Z, A, B),
)  # fmt: skip
pivot_height = _length(
    "pivot_height", "R_d + C_t", 0.0, 400.0, "R_d + C_t: height of the blade tips over the B axis at Z = 0"
)
cutter_center_w = _vector(
    "cutter_center_w", r"\mathbf{c}", "mm", 300.0, 500.0, "cutter centre in the tip plane, work frame w"
)
cutter_axis_w = _vector("cutter_axis_w", r"\mathbf{k}_c", "1", 1.0, 1.0, "cutter axis towards the work, work frame w")
line_point = _vector("line_point", r"\mathbf{p}", "mm", 300.0, 200.0, "point at distance zero of a line, work frame w")
line_direction = _vector("line_direction", r"\mathbf{d}", "1", 1.0, 1.0, "unit direction of a line, work frame w")
line_distance = Quantity(
    "line_distance", "where the line enters the swept blade; 1e3 where it does not", "mm", "t", scale=1000.0
)  # fmt: skip

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
    "surface_coefficients", "coefficients c_1 ... c_10 of the cubic deviation surface, mm per mm^k", "mixed", "c",
    (-1.0, 1.0), shape=(10,),
)  # fmt: skip
monomials = Quantity(
    "monomials", "1, X, Y, X^2, XY, Y^2, X^3, X^2 Y, X Y^2, Y^3", "mixed", "m", shape=(10,), scale=1e5
)  # fmt: skip
surface_deviation = Quantity(
    "surface_deviation", "deviation that the cubic surface gives at one point", "mm", r"\delta", scale=1e5
)  # fmt: skip

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
    "feed_sign", "+1 if the counts of the feed go up in climb hobbing, -1 if in conventional", "1", "s_f", (-1, 1),
    values=(-1, 1),
)  # fmt: skip
profile_shift = Quantity("profile_shift", "profile shift in normal modules", "1", "x", (-0.4, 1.0))
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
    "best_spanned_teeth", "number of teeth at which the span touches at d + 2 x m_n, before rounding", "1", "k_{th}",
    scale=100.0,
)  # fmt: skip
span = _length("span", "W_k", 0.0, 1e5, "base tangent length over the spanned teeth")
span_contact_diameter = _length("span_contact_diameter", "d_W", 0.0, 1e5, "diameter at which the span touches")
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
thread_pitch = _length("thread_pitch", "P", 0.01, 100.0, "pitch of the thread to be cut")
thread_starts = _count("thread_starts", "k", 1, 10, "starts of the thread")
thread_sign = Quantity("thread_sign", "+1 right-hand, -1 left-hand thread", "1", "s_t", (-1, 1), values=(-1, 1))
lead_screw_pitch = _length("lead_screw_pitch", "P_L", 0.01, 100.0, "travel of the carriage per turn of the lead screw")
lead_screw_ratio = Quantity(
    "lead_screw_ratio", "motor steps per count of the spindle, signed", "1", r"\kappa_t", scale=1e6
)

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
    "blank", "blank of one member, pitch apex in the crossing point", "mixed", r"\mathbf{b}", shape=(8,),
    components=(
        pitch_angle, face_angle, root_angle, mean_cone_distance, face_width, mean_addendum, mean_dedendum, clearance,
    ),
)  # fmt: skip
across = Quantity("across", "place along the tooth: 0 toe, 1 heel", "1", r"\xi", (0.0, 1.0))
up = Quantity("up", "place up the working depth: 0 lower limit, 1 tip", "1", r"\eta", (0.0, 1.0))
axial = Quantity("axial", "coordinate z_w of a flank point", "mm", "z_w", (5.0, 300.0), scale=300.0)
radial = Quantity("radial", "distance of a flank point from the member's axis", "mm", "r_w", (5.0, 300.0), scale=300.0)
contact = Quantity(
    "contact", "surface parameters u, beta, theta of a flank point", "mixed", r"(u, \beta, \theta)", shape=(3,),
    components=(u, beta, theta), scale=100.0,
)  # fmt: skip
turning = Quantity(
    "turning", "angle by which a flank is turned about z_w to leave this deviation", "rad", r"\varepsilon", scale=1.0
)
arc = Quantity("arc", "the same as an arc at the radius of the point", "mm", "s", scale=300.0)
deviation_in = Quantity("deviation_in", "measured deviation along the outward normal", "mm", r"\delta", (-0.5, 0.5))

# --- every motion and every blade -------------------------------------------------------------------------------
motion = Quantity(
    "motion", "coefficients of theta^1 ... theta^7 (columns) of the machine settings (rows, in their order)", "mixed",
    "m", (-0.3, 0.3), shape=(10, 7),
)  # fmt: skip
index_ratio = Quantity(
    "index_ratio", "work rotation per cutter rotation, blade groups over teeth; 0 in face milling", "1", r"\iota",
    (-0.8, 0.8),
)  # fmt: skip
blade_offset_angle = _angle("blade_offset_angle", r"\eta", -0.5, 0.5, "turn of the blade's plane about its point")
arc_angle = _angle("arc_angle", "u", 0.05, 1.5, "angle of the blade's normal against the tip plane, on an arc blade")
blade_arc = Quantity(
    "blade_arc", "arc blade: radius and height of its centre, and its radius (positive = convex blade)", "mm",
    r"\mathbf{a}", shape=(3,),
    components=(
        _length("arc_center_radius", r"\rho_b", 20.0, 250.0, "distance of the arc's centre from the cutter axis"),
        _length("arc_center_height", "h_b", -50.0, 50.0, "height of the arc's centre above the tip plane"),
        _length("arc_radius", "r", 0.2, 15.0, "radius of the arc"),
    ),
)  # fmt: skip
main_arc = Quantity(
    "main_arc", "arc of a circular-arc blade: radius and height of its centre, and its radius", "mm", r"\mathbf{a}_r",
    shape=(3,),
    components=(
        _length("main_center_radius", r"\rho_b", -700.0, 900.0, "distance of the arc's centre from the cutter axis"),
        _length("main_center_height", "h_b", -50.0, 300.0, "height of the arc's centre above the tip plane"),
        _length("main_radius", "r", 200.0, 800.0, "radius of the arc, positive where the blade is convex"),
    ),
)  # fmt: skip
toprem_angle = _angle("toprem_angle", r"\alpha_T", 0.01, 0.6, "angle between the Toprem section and the cutter axis")
toprem_height = _length("toprem_height", "h_T", 0.0, 5.0, "height above the tip plane at which Toprem ends")
toprem_point_radius = _length(
    "toprem_point_radius", "r_{pT}", 20.0, 250.0, "radius at which Toprem meets the tip plane"
)
blade_spheric_radius = _length("blade_spheric_radius", "r", 200.0, 2000.0, "radius of a circular-arc blade")
reference_height = _length("reference_height", "h_r", 0.0, 15.0, "height at which arc and straight blade touch")
blade_edge_radius = _length("blade_edge_radius", "r_e", 0.1, 3.0, "radius of the rounded blade edge")
joint_height = _length("joint_height", "h_j", 0.0, 5.0, "height above the tip plane at which edge and blade join")
joint_angle = _angle("joint_angle", r"u_j", 0.0, 1.5, "angle of the normal at which edge and arc blade join")
roll_coefficients = Quantity(
    "roll_coefficients", "modified roll 2C, 6D, 24E, 120F", "1", "(2C, 6D, 24E, 120F)", (-50.0, 50.0), shape=(4,),
)  # fmt: skip
roll_motion = Quantity(
    "roll_motion", "coefficients of theta^1 ... theta^7 of the work rotation offset", "rad", r"m_{\varphi}",
    shape=(7,), scale=100.0,
)  # fmt: skip
