"""Two runs of a member in one picture: both flanks and the pitch of the earlier and of the later run."""

from __future__ import annotations

from matplotlib.figure import Figure

from gearmath.plot.member import member_figure
from gearmath.quality.evaluation import Evaluation
from gearmath.quality.pitch import Pitch
from gearmath.quality.topography import Topography


def comparison_figure(title: str, before: Evaluation, after: Evaluation) -> Figure:
    """Mean topographies at one scale, as they deviate from the nominal flank, and pitch, as far as both have them."""
    return member_figure(title, _forms(before), _forms(after), _pitches(before), _pitches(after))


def _forms(found: Evaluation) -> dict[str, Topography]:
    return {flank: figures.mean for flank, figures in found.flanks.items() if figures.mean is not None}


def _pitches(found: Evaluation) -> list[Pitch]:
    return [figures.pitch for figures in found.flanks.values() if figures.pitch is not None]
