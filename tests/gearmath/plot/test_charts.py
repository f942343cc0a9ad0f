"""Charts show the numbers they were given: read from their artists, not from their pixels."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.text import Text

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.plot import evaluation_figure, uncertainty_figure
from gearmath.plot.pitch import pitch_limits
from gearmath.plot.sheet import pitch_chart, runout_chart, tooth_chart, topography_chart
from gearmath.plot.style import round_length, signed
from gearmath.plot.tooth import _SHADES, draw_tooth, tooth_flanks
from gearmath.plot.topography import draw_topography, um_per_row
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.quality.evaluation.pitch import Pitch
from gearmath.quality.evaluation.spaces import Runout
from gearmath.quality.evaluation.topography import Topography
from gearmath.quality.uncertainty.figures import Figure as Named
from gearmath.quality.uncertainty.propagation import Uncertain
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import join

REFERENCE = (2, 4)


def flank(deviation_um, name="concave", columns=9):
    """A topography of 5 rows on a plane, 3 mm by 2 mm a mesh."""
    up, along = np.meshgrid(2.0 * (np.arange(5) - 2), 3.0 * (np.arange(columns) - columns // 2), indexing="ij")
    deviation = np.broadcast_to(np.asarray(deviation_um, dtype=float), up.shape) / 1000
    return Topography(name, 0, deviation, np.zeros(10), 0 * deviation, along, up)


def drawn(*arguments, **options):
    figure = Figure(figsize=(4, 3), layout="constrained")
    axes = figure.subplots()
    draw_topography(axes, *arguments, **options)
    return figure, axes


def nodes(axes):
    """The text at every point of the grid, by row and column, and its annotation."""
    found = {}
    for text in axes.texts:
        if match := re.fullmatch(r"node (\d+),(\d+)", text.get_gid() or ""):
            found[int(match[1]), int(match[2])] = text
    return found


def number(text):
    return float(text.replace("\N{MINUS SIGN}", "-"))


@pytest.fixture
def uneven():
    return 0.1 * np.round(10 * np.random.default_rng(7).uniform(-30, 30, (5, 9)))


def test_every_point_of_the_grid_has_its_deviation_in_micrometres_and_its_sign(uneven):
    _, axes = drawn(flank(uneven))
    found = nodes(axes)
    assert set(found) == set(np.ndindex(5, 9))
    for place, text in found.items():
        assert number(text.get_text()) == pytest.approx(uneven[place], abs=0.0501)
        assert text.get_text()[0] in ("+", "\N{MINUS SIGN}") or uneven[place] == 0


def test_numbers_do_not_cover_each_other_at_the_size_of_the_sheet():
    """Also where every one has as many digits as there can be."""
    for sign in (1, -1):
        figure = topography_chart(flank(-88.8 * sign * np.ones((5, 9))), 100.0, 0.0)
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        boxes = [text.get_window_extent() for text in nodes(figure.axes[0]).values()]
        assert len(boxes) == 45
        for k, box in enumerate(boxes):
            assert not any(box.overlaps(other) for other in boxes[k + 1 :])
            assert box.height > 0.85 * 8 * figure.dpi / 72  # eight points, a chart being as wide as half of A4


def test_a_deviation_is_as_long_on_paper_as_the_scale_bar_says(uneven):
    _, axes = drawn(flank(uneven))
    (bar,) = (line for line in axes.lines if line.get_gid() == "scale bar")
    (label,) = (text.get_text() for text in axes.texts if text.get_text().endswith("µm"))
    um_a_unit = float(label.split()[0]) / np.ptp(bar.get_ydata())
    lengths = [
        (y2 - y1) * um_a_unit
        for lines in axes.collections
        for (_, y1), (_, y2) in (np.array(segment) for segment in lines.get_segments())
    ]
    assert sorted(lengths) == pytest.approx(sorted(uneven.ravel()), abs=1e-9)


def test_before_and_after_have_the_same_scale_in_one_chart_and_side_by_side():
    before, after = flank(20.0), flank(2.0, "convex")
    scale = um_per_row([before, after])
    heights = []
    for shown in (before, after):
        (bar,) = (line for line in topography_chart(shown, scale, None).axes[0].lines if line.get_gid() == "scale bar")
        heights.append(np.ptp(bar.get_ydata()))
    assert heights[0] == heights[1]
    _, axes = drawn(after, before)
    lines = {line.get_label(): line.get_ydata()[0] for line in axes.lines if not line.get_label().startswith("_")}
    assert (lines["before"] - lines["nominal"]) / (lines["after"] - lines["nominal"]) == pytest.approx(10.0)


def test_edges_are_named_where_they_are(uneven):
    _, axes = drawn(flank(uneven))
    at = {text.get_text(): text.get_position() for text in axes.texts if text.get_text().isalpha()}
    assert at["root"][1] < 0 < 4 < at["tip"][1]
    assert at["toe"][0] < at["root"][0] < at["heel"][0]


def test_what_was_taken_off_and_left_out_is_said_and_marked(uneven):
    uneven[0, 3] = np.nan
    _, axes = drawn(flank(uneven), taken=0.0234)
    assert axes.get_xlabel() == "zero at the ring, +23.4 µm taken off there; 1 of 45 points left out (×)"
    assert nodes(axes)[0, 3].get_text() == "×"
    (ring,) = (line for line in axes.lines if line.get_gid() == "reference")
    (x, y), text = (ring.get_xdata()[0], ring.get_ydata()[0]), nodes(axes)[REFERENCE]
    assert text.xy == (x, y)
    assert drawn(flank(uneven))[1].get_xlabel().startswith("not zeroed")


def test_a_wide_grid_has_numbers_that_can_be_read_and_says_which():
    _, axes = drawn(flank(np.ones((5, 31)), columns=31))
    assert {column for _, column in nodes(axes)} == set(range(0, 31, 4))
    assert axes.get_title() == "numbers at one column in 4"


def test_bars_are_the_single_pitch_and_the_curve_is_cumulative():
    """f_pt of 5, -2 and -3 µm: the last tooth to the first closes the circle."""
    pitch = Pitch("convex", np.zeros(3), np.array([0.0, 5.0, 3.0]) / 1000)
    figure = pitch_chart(pitch, None, pitch_limits([pitch]))
    bars, curve = figure.axes
    assert [bar.get_height() for bar in bars.patches] == pytest.approx([-3.0, 5.0, -2.0])
    assert [bar.get_x() + bar.get_width() / 2 for bar in bars.patches] == pytest.approx([0, 1, 2])
    assert curve.lines[0].get_ydata() == pytest.approx([0.0, 5.0, 3.0])


def test_a_tooth_without_a_reading_has_a_cross_and_no_bar():
    pitch = Pitch("convex", np.zeros(4), np.array([0.0, np.nan, 3.0, 1.0]) / 1000)
    bars, curve = pitch_chart(pitch, None, pitch_limits([pitch])).axes
    crosses = {
        axes: [list(line.get_xdata()) for line in axes.lines if line.get_marker() == "x"] for axes in (bars, curve)
    }
    assert crosses == {bars: [[1, 2]], curve: [[1]]}  # the tooth after it has no neighbor to be compared with
    assert [bar.get_height() for bar in bars.patches] == pytest.approx([-1.0, 0.0, 0.0, -2.0])


def test_axes_of_pitch_begin_and_end_beyond_every_value_and_without_any_at_zero():
    pitches = [Pitch("convex", np.zeros(3), np.array([0.0, s, np.nan]) / 1000) for s in (-7.0, 4.0)]
    for low, high in pitch_limits(pitches):
        assert low < -7.0 < 4.0 < high
    for low, high in pitch_limits([]):
        assert low < 0 < high


def figures():
    """Both flanks have f_pt of three teeth and F_p, only one a mean, and both together F_r; values 1, 2, 3 ... µm."""
    names = [(each, name) for each in FLANKS for name in ("f_pt_0", "f_pt_1", "f_pt_2", "F_p")]
    names += [("convex", "mean"), ("both", "F_r"), ("both", "rotation")]
    units = ["um"] * (len(names) - 1) + ["arcsec"]
    return [
        Uncertain(Named(each, name, unit), k / 1000, 5e-4, ((k - 1) / 1000, (k + 2) / 1000), None)
        for k, ((each, name), unit) in enumerate(zip(names, units, strict=True), 1)
    ]


def test_uncertainty_picture_has_each_figure_at_its_own_tick():
    """Tick labels and points correspond one to one, and each point is the value of the figure that its tick names."""
    found = figures()
    concave, convex, rest = uncertainty_figure("m.csv", found).axes
    for axes, name in ((concave, "concave"), (convex, "convex")):
        (points,) = (container for container in axes.containers)
        assert name in axes.get_ylabel()
        assert list(points[0].get_xdata()) == list(axes.get_xticks()) == [0, 1, 2]
        assert [tick.get_text() for tick in axes.get_xticklabels()] == ["0", "1", "2"]
        wanted = [one.value * 1000 for one in found if one.figure.flank == name and "f_pt" in one.figure.name]
        assert list(points[0].get_ydata()) == pytest.approx(wanted)
    labels = [tick.get_text() for tick in rest.get_yticklabels()]
    at = {}
    for points in rest.containers:
        for x, y in zip(points[0].get_xdata(), points[0].get_ydata(), strict=True):
            at[labels[list(rest.get_yticks()).index(y)]] = x
        (spread,) = points[2]
        for (low, _), (high, _) in (np.array(segment) for segment in spread.get_segments()):
            assert high - low == pytest.approx(3.0)
    wanted = {
        f"{one.figure.name.replace('_', ' ')}, {one.figure.flank}": one.value * 1000
        for one in found
        if one.figure.unit == "um" and "f_pt" not in one.figure.name
    }
    assert len(labels) == len(set(labels)) == len(wanted)
    assert at == pytest.approx(wanted)


def test_uncertainty_picture_of_many_teeth_has_a_tick_each_and_numbers_that_fit():
    found = [Uncertain(Named("concave", f"f_pt_{k}", "um"), k / 1000, 1e-3, (0, 1), None) for k in range(120)]
    (axes,) = uncertainty_figure("m.csv", found).axes
    assert list(axes.get_xticks()) == list(range(120))
    shown = [tick.get_text() for tick in axes.get_xticklabels() if tick.get_text()]
    assert shown == [str(k) for k in range(0, 120, 5)]


@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_the_two_flanks_drawn_bound_a_tooth_and_not_a_space(gear_set, member):
    """The outward normals of a tooth point away from its other flank; those of a space towards it."""
    spec = getattr(gear_set, member)
    file = join([nominal_flank(spec, name, blank_grid(spec)) for name in FLANKS])
    one, other = tooth_flanks(file, {name: flank(0.0, name) for name in FLANKS}, spec.teeth).values()
    across = other.point[REFERENCE] - one.point[REFERENCE]
    assert across @ one.normal[REFERENCE] < 0 < across @ other.normal[REFERENCE]
    assert np.linalg.norm(across) < 2 * np.pi * np.hypot(*one.point[REFERENCE][:2]) / spec.teeth  # a pitch


def test_perspective_lifts_what_is_left_on_out_of_the_flank_and_shades_it_darker(gear_set):
    spec = gear_set.pinion
    file = join([nominal_flank(spec, name, blank_grid(spec)) for name in FLANKS])
    tilted = np.broadcast_to(10.0 * (np.arange(9) - 4), (5, 9))
    flanks = tooth_flanks(file, {name: flank(tilted, name) for name in FLANKS}, spec.teeth)
    figure = Figure(figsize=(4, 3))
    axes = figure.subplots()
    draw_tooth(axes, flanks, "convex", 100.0)
    lifted = max(axes.collections, key=lambda each: each.get_zorder())
    grays = [np.dot(to_rgb(color), (0.299, 0.587, 0.114)) for color in lifted.get_facecolor()]
    rows = np.array(grays).reshape(4, 8)
    assert (np.diff(rows, axis=1) < 0).all()
    assert {text.get_text() for text in axes.texts} >= {"root", "tip", "toe", "heel", "+40.0", "\N{MINUS SIGN}40.0"}


def test_shades_become_darker_all_the_way_so_that_a_print_without_color_has_the_sign():
    grays = [np.dot(_SHADES(x)[:3], (0.299, 0.587, 0.114)) for x in np.linspace(0, 1, 50)]
    assert (np.diff(grays) < 0).all()


def test_a_file_name_with_dollars_is_a_name_and_no_formula(gear_set):
    spec = gear_set.pinion
    file = join([nominal_flank(spec, name, blank_grid(spec)) for name in FLANKS])
    file = replace(file, deviation=np.zeros(len(file)))
    found = evaluate_member(file, spec, registered=False)
    for figure in (evaluation_figure("a$^b$.csv", found), uncertainty_figure("a$^b$.csv", figures())):
        FigureCanvasAgg(figure).draw()
        assert figure.get_suptitle().startswith("a$^b$.csv")


def test_every_word_of_every_chart_of_the_sheet_lies_within_its_picture(gear_set):
    """Of a member of 36 teeth and long numbers."""
    spec = gear_set.gear
    file = join([nominal_flank(spec, name, blank_grid(spec)) for name in FLANKS])
    flanks = tooth_flanks(file, {name: flank(-88.8, name) for name in FLANKS}, spec.teeth)
    wave = 0.1234 * np.sin(2 * np.pi * np.arange(36) / 36)
    pitch, runout = Pitch("concave", 0 * wave, wave), Runout(wave, 2 * np.pi * np.arange(36) / 36, np.eye(36))
    figures = [
        topography_chart(flank(-88.8), 100.0, 0.1234),
        pitch_chart(pitch, pitch, pitch_limits([pitch])),
        runout_chart(runout),
        tooth_chart(flanks, "concave", 50.0),
    ]
    for figure in figures:
        FigureCanvasAgg(figure).draw()
        beyond = {  # labels of ticks outside of the axes are not drawn
            tick.label1
            for axis in (axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis))
            for tick in axis.get_major_ticks()
            if not axis.get_view_interval()[0] <= tick.get_loc() <= axis.get_view_interval()[1]
        }
        words = [text for text in figure.findobj(Text) if text.get_text() and text not in beyond]
        assert len(words) > 5
        for text in words:
            box = text.get_window_extent()
            assert figure.bbox.x0 <= box.x0 < box.x1 <= figure.bbox.x1, text
            assert figure.bbox.y0 <= box.y0 < box.y1 <= figure.bbox.y1, text


def test_numbers_have_signs_and_scale_bars_round_lengths():
    assert [signed(x) for x in (1.04, -0.26, 0.04, -0.04, 99.94, -123.4)] == [
        "+1.0",
        "\N{MINUS SIGN}0.3",
        "0.0",
        "0.0",
        "+99.9",
        "\N{MINUS SIGN}123",
    ]
    assert [round_length(x) for x in (1.0, 4.9, 5.0, 19.0, 0.3)] == pytest.approx([1, 2, 5, 10, 0.2])
