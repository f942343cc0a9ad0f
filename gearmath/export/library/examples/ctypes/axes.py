"""Axis positions by ctypes: python axes.py /path/to/libgearmath.so.1 (or gearmath.dll)."""

import ctypes
import sys

NODES = 9
#: The concave flank of the pinion of NASA TP-3096, 12 x 36 teeth, in mm and rad.
SETTINGS = (
    *(74.874171554126, -1.1159989619985908, 0.0, 0.0, 3.9262277584, 0.296487393552, 1.021857658688),
    *(0.2943788667042891, 3.2426985355495, 0.0, 75.326783002724, 0.31495635289994856),
)


def main() -> int:
    library = ctypes.CDLL(sys.argv[1])
    library.gm_error_text.restype = ctypes.c_char_p
    library.gm_version.restype = ctypes.c_char_p
    batch = library.gm_axis_transform_batch
    array, stride = ctypes.POINTER(ctypes.c_double), ctypes.c_int64
    batch.argtypes = [stride, *(array, stride) * 4, array, ctypes.POINTER(ctypes.c_int64)]
    assert library.gm_abi_version() == 1

    def doubles(*values: float) -> ctypes.Array:
        return (ctypes.c_double * len(values))(*values)

    theta = doubles(*(-0.16 + 0.04 * k for k in range(NODES)))
    axes, first_bad = doubles(*[0.0] * 5 * NODES), ctypes.c_int64()
    given = (doubles(*SETTINGS), 0, theta, 1, doubles(500.0), 0, doubles(0.0, 0.0, 0.0), 0)
    status = batch(NODES, *given, axes, first_bad)
    if status:
        print(f"node {first_bad.value}: {library.gm_error_text(status).decode()}", file=sys.stderr)
        return 1
    for k in range(NODES):
        print(f"theta {theta[k]:+.2f}", " ".join(f"{name} {axes[5 * k + j]:.5f}" for j, name in enumerate("XYZAB")))
    theta[4] = float("nan")
    status = batch(NODES, *given, axes, first_bad)
    print(f"node {first_bad.value} refused: {library.gm_error_text(status).decode()}")
    return 0 if first_bad.value == 4 else 1


if __name__ == "__main__":
    sys.exit(main())
