"""What the CAD kernel says of a STEP file that it has read: its solids, and how points lie to them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np


def read_step(path: Path) -> Any:
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPControl import STEPControl_Reader

    reader = STEPControl_Reader()
    assert reader.ReadFile(str(path)) == IFSelect_ReturnStatus.IFSelect_RetDone
    reader.TransferRoots()
    return reader.OneShape()


def solids_of(shape: Any) -> list[Any]:
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    explorer, found = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_SOLID), []
    while explorer.More():
        found.append(TopoDS.Solid(explorer.Current()))
        explorer.Next()
    return found


def is_closed(solid: Any) -> bool:
    """Whether the one shell of a solid has no free edge."""
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(solid, TopAbs_ShapeEnum.TopAbs_SHELL)
    closed = BRep_Tool.IsClosed_s(explorer.Current())
    explorer.Next()
    return closed and not explorer.More()


def inside(solid: Any, points: np.ndarray) -> np.ndarray:
    """Which points (n,3) lie in a solid."""
    from OCP.BRepClass3d import BRepClass3d_SolidClassifier
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_State

    classifier, found = BRepClass3d_SolidClassifier(solid), []
    for point in points:
        classifier.Perform(gp_Pnt(*map(float, point)), 1e-7)
        found.append(classifier.State() == TopAbs_State.TopAbs_IN)
    return np.array(found)


def distances(shape: Any, points: np.ndarray) -> np.ndarray:
    """Of points (n,3) from the nearest surface of a shape [mm], never too small: from a foot of the CAD kernel."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRep import BRep_Tool
    from OCP.BRepBndLib import BRepBndLib
    from OCP.gp import gp_Pnt
    from OCP.ShapeAnalysis import ShapeAnalysis_Surface
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    explorer, faces = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_FACE), []
    while explorer.More():
        face, box = TopoDS.Face(explorer.Current()), Bnd_Box()
        BRepBndLib.Add_s(face, box)
        box.Enlarge(0.001)
        faces.append((box, ShapeAnalysis_Surface(BRep_Tool.Surface_s(face))))
        explorer.Next()

    def gap(surface, at) -> float:
        surface.ValueOfUV(at, 1e-9)
        return surface.Gap()

    places = [gp_Pnt(*map(float, point)) for point in points]
    return np.array([min(gap(surface, at) for box, surface in faces if not box.IsOut(at)) for at in places])
