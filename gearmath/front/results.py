"""What the calls of the front door return, by name: for annotations, ``isinstance``, and to read what a result has.

They stand by themselves, for nobody makes one: a :class:`Correction` comes from ``Measurement.compensate``.
"""

from __future__ import annotations

from gearmath.front.contact import Contact
from gearmath.front.corrected import Correction
from gearmath.front.design import Blank, FoundSettings, PairDesign
from gearmath.front.evaluated import Evaluation
from gearmath.front.flanks import FlankSurface, Tooth
from gearmath.front.hobbed import HobbedGear, HobbedThread
from gearmath.front.judged import Uncertainty
from gearmath.front.probing import ProbingProgram
from gearmath.front.timing import ProgramTime

__all__ = (
    "Blank",
    "Contact",
    "Correction",
    "Evaluation",
    "FlankSurface",
    "FoundSettings",
    "HobbedGear",
    "HobbedThread",
    "PairDesign",
    "ProbingProgram",
    "ProgramTime",
    "Tooth",
    "Uncertainty",
)


def __dir__() -> list[str]:  # for completion
    return list(__all__)
