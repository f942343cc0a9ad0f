"""Pictures of what was measured: the only package that draws, a kind of chart a module."""

from gearmath.plot.gearbox import draw_gearbox_error
from gearmath.plot.member import evaluation_figure, member_figure
from gearmath.plot.saving import png, save, svg
from gearmath.plot.uncertainty import uncertainty_figure

__all__ = ["draw_gearbox_error", "evaluation_figure", "member_figure", "png", "save", "svg", "uncertainty_figure"]
