"""The inspection sheet of one member, or of both: what was left out, what the gear is like, which settings correct it.

One page for people, self-contained, and its pictures. Nothing is computed here that an evaluation, an uncertainty or a
correction has not said.
"""

from gearmath.report.measurement import FIELDS, Report, ReportedMeasurement, head_of
from gearmath.report.sheet import STEPS, inspection_sheet

__all__ = ["FIELDS", "STEPS", "Report", "ReportedMeasurement", "head_of", "inspection_sheet"]
