"""The kernel of an expression by its name, as users ask for it: :mod:`gearmath.kernels` is asked in every loop."""

from __future__ import annotations

from gearmath import kernels
from gearmath.arguments.call import checked_call

__all__ = ("kernel",)

kernel = checked_call(kernels.kernel)
