"""gearmath: gear cutting from first principles to metal.

Nothing is derived or loaded on import; every chapter is derived on first use.
"""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("gearmath")
except PackageNotFoundError:  # used from a bare source tree
    __version__ = "0+unknown"
