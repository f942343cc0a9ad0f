"""STEP of a member, or of the pair in mesh, as closed solids bounded by B-splines; the only module that loads the
CAD kernel (extra ``cad``)."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gearmath.errors import ComputationError, InputError
from gearmath.exchange.spline import Patch
from gearmath.files import write_bytes
from gearmath.shown import Shown, Shows

#: Borders that belong together lie this close [mm]; they are the same but for rounding.
_SAME = 1e-6


@dataclass(frozen=True, repr=False)
class WrittenSolid(Shown):
    """A closed solid: how many faces it has, and its volume [mm³]."""

    faces: int
    volume: float

    def _shown(self) -> tuple[str, list[Shows]]:
        return "closed solid", [("faces", self.faces, ""), ("volume", self.volume, "mm³")]


def write_step(
    path: Path, bodies: Sequence[tuple[str, Sequence[Patch]]], progress: Callable[[int], object] = lambda _: None
) -> dict[str, WrittenSolid]:
    """Write closed solids [mm]; what was written, by name.

    Raises InputError where the extra ``cad`` is not installed, ComputationError where patches do not close.
    """
    require_kernel()
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.Interface import Interface_Static
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

    solids = []
    for name, patches in bodies:
        solids.append(_solid(name, patches))
        progress(1)
    with _silence(), tempfile.TemporaryDirectory() as folder:
        writer = STEPControl_Writer()
        Interface_Static.SetCVal_s("write.step.unit", "MM")
        for solid in solids:
            writer.Transfer(solid, STEPControl_StepModelType.STEPControl_ManifoldSolidBrep)
        target = Path(folder) / "solid.step"
        if writer.Write(str(target)) != IFSelect_ReturnStatus.IFSelect_RetDone:
            raise ComputationError("the CAD kernel could not write the STEP file")
        write_bytes(path, target.read_bytes())
    progress(1)
    written = zip(bodies, solids, strict=True)
    return {name: WrittenSolid(len(patches), volume_of(solid)) for (name, patches), solid in written}


def volume_of(solid: Any) -> float:
    """Volume [mm³] of a solid of the CAD kernel."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(solid, found)
    return float(found.Mass())


def _solid(name: str, patches: Sequence[Patch]) -> Any:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeSolid, BRepBuilderAPI_Sewing
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepLib import BRepLib
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopoDS import TopoDS

    with _silence():
        sewing = BRepBuilderAPI_Sewing(_SAME)
        for patch in patches:
            sewing.Add(BRepBuilderAPI_MakeFace(surface(patch), _SAME).Face())
        sewing.Perform()
        shell = sewing.SewedShape()
        if sewing.NbFreeEdges() or shell.ShapeType() != TopAbs_ShapeEnum.TopAbs_SHELL:
            raise ComputationError(f"{name}: the surfaces do not close: {sewing.NbFreeEdges()} edges are free")
        solid = BRepBuilderAPI_MakeSolid(TopoDS.Shell(shell)).Solid()
        BRepLib.OrientClosedSolid_s(solid)
        if not BRepCheck_Analyzer(solid).IsValid():
            raise ComputationError(f"{name}: the CAD kernel finds the solid invalid")
    return solid


def surface(patch: Patch) -> Any:
    """A patch as surface of the CAD kernel."""
    from OCP.collections import Array2_gp_Pnt
    from OCP.Geom import Geom_BSplineSurface
    from OCP.gp import gp_Pnt

    n, m = patch.poles.shape[:2]
    poles = Array2_gp_Pnt(1, n, 1, m)
    for i, j in np.ndindex(n, m):
        poles.SetValue(i + 1, j + 1, gp_Pnt(*(float(value) for value in patch.poles[i, j])))
    (u, times_u), (v, times_v) = (_knots(knots) for knots in (patch.u_knots, patch.v_knots))
    return Geom_BSplineSurface(poles, u, v, times_u, times_v, *patch.degrees)


def _knots(knots: np.ndarray) -> tuple[Any, Any]:
    """Different knots, and how often each is there."""
    from OCP.collections import Array1_double, Array1_int

    values, counts = np.unique(knots, return_counts=True)
    at, times = Array1_double(1, len(values)), Array1_int(1, len(values))
    for k, (value, count) in enumerate(zip(values, counts, strict=True)):
        at.SetValue(k + 1, float(value))
        times.SetValue(k + 1, int(count))
    return at, times


def require_kernel() -> None:
    """Raise InputError where the extra ``cad`` is not installed."""
    try:
        import OCP.STEPControl  # noqa: F401
    except ImportError as error:
        raise InputError("STEP needs the CAD kernel: install it with pip install '.[cad]'") from error


@contextlib.contextmanager
def _silence() -> Any:
    """Without what the CAD kernel prints on its own."""
    from OCP.Message import Message

    printers = Message.DefaultMessenger_s()
    printers.ChangePrinters().Clear()
    yield
