"""The set-up sheet of a program: a page for the one who clamps, sets tools and starts, with drawings to scale."""

from gearmath.setup_sheet.calibrating import calibration_sheet
from gearmath.setup_sheet.probing import ProbingJob, probing_sheet
from gearmath.setup_sheet.sheet import setup_sheet

__all__ = ["ProbingJob", "calibration_sheet", "probing_sheet", "setup_sheet"]
