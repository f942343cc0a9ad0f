"""Frames and rotations: active and right-handed, as everywhere in this package.

A rotation ``R(a)`` turns a vector by the angle ``a`` and keeps the frame. The matrix whose *rows* are the axes of a
frame w, written in frame s, takes the components of a vector in s to its components in w.
"""

from __future__ import annotations

import sympy as sp

I = sp.ImmutableDenseMatrix([1, 0, 0])
J = sp.ImmutableDenseMatrix([0, 1, 0])
K = sp.ImmutableDenseMatrix([0, 0, 1])


def Rx(a: sp.Expr) -> sp.Matrix:
    """Rotation about x by ``a`` [rad]."""
    return sp.Matrix([[1, 0, 0], [0, sp.cos(a), -sp.sin(a)], [0, sp.sin(a), sp.cos(a)]])


def Rz(a: sp.Expr) -> sp.Matrix:
    """Rotation about z by ``a`` [rad]."""
    return sp.Matrix([[sp.cos(a), -sp.sin(a), 0], [sp.sin(a), sp.cos(a), 0], [0, 0, 1]])


def rotation(axis: sp.Matrix, a: sp.Expr) -> sp.Matrix:
    """Rotation by ``a`` [rad] about the unit vector ``axis`` (Rodrigues' formula)."""
    x, y, z = axis
    cross = sp.Matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return sp.eye(3) * sp.cos(a) + cross * sp.sin(a) + axis * axis.T * (1 - sp.cos(a))


def prove_rotations_about_the_axes_are_rodrigues() -> None:
    """(D0.1) Rx and Rz are the general rotation about a unit vector, for the axes x and z."""
    a = sp.Symbol("a", real=True)
    assert sp.simplify(rotation(sp.Matrix(I), a) - Rx(a)) == sp.zeros(3)
    assert sp.simplify(rotation(sp.Matrix(K), a) - Rz(a)) == sp.zeros(3)
