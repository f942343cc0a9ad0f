"""Point text: the same points in every dress that a measuring machine may give them, and rows that are not whole."""

from __future__ import annotations

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.specs.point_text import read_point_text

#: Typed by hand, so that no writer has a say.
POINTS = [[12.5, -3.25, 80.125], [13.0, -3.5, 81.0625], [14.75, 0.00015, 79.5]]
NORMALS = [[0.6, 0.8, 0.0], [0.0, 0.6, -0.8], [1.0, 0.0, 0.0]]
LAYOUTS = {
    "blanks": "12.5 -3.25 80.125\n13.0 -3.5 81.0625\n14.75 0.00015 79.5\n",
    "header, comments, blank lines, end": (
        "GEAR MEASUREMENT 2026-11-27 12:30:15\nPart no: 4711\n3 points\n\n# x y z\n  12.5   -3.25  80.125\n\n"
        "13.0 -3.5 81.0625\n! probe changed\n14.75 0.00015 79.5\nEND\n"
    ),
    "CRLF, BOM, tabs": "\ufeffx\ty\tz\r\n12.5\t-3.25\t80.125\r\n13.0\t-3.5\t81.0625\r\n14.75\t0.00015\t79.5\r\n",
    "commas": "12.5,-3.25,80.125\n13.0,-3.5,81.0625\n14.75,0.00015,79.5\n",
    "commas and blanks": "12.5, -3.25, 80.125\n13.0, -3.5, 81.0625\n14.75, 0.00015, 79.5",
    "semicolons, decimal commas": "X;Y;Z\n12,5;-3,25;80,125\n13,0;-3,5;81,0625\n14,75;0,00015;79,5\n",
    "blanks, decimal commas": "12,5 -3,25 80,125\n13,0 -3,5 81,0625\n14,75 0,00015 79,5\n",
    "tabs, decimal commas": "12,5\t-3,25\t80,125\n13,0\t-3,5\t81,0625\n14,75\t0,00015\t79,5\n",
    "semicolon at the end": "12.5; -3.25; 80.125;\n13.0; -3.5; 81.0625;\n14.75; 0.00015; 79.5;\n",
    "Fortran exponents": "1.25D+01 -3.25D0 8.0125d1\n1.3D1 -.35D1 8.10625D1\n1.475D1 1.5D-04 7.95D1\n",
    "exponents of a control": "1.25EX01 -3.25 80.125\n13. -3.5 81.0625\n14.75 1.5EX-04 79.5\n",
    "point numbers": "1 12.5 -3.25 80.125\n2 13.0 -3.5 81.0625\n3 14.75 0.00015 79.5\n",
    "row, column and text": "P 0 0 12.5 -3.25 80.125\nP 0 1 13.0 -3.5 81.0625\nP 1 0 14.75 0.00015 79.5\n",
    "counts in the header": "3 1 3\n12.5 -3.25 80.125\n13.0 -3.5 81.0625\n14.75 0.00015 79.5\n",
    "units and letters": "X=12.5mm Y=-3.25mm Z=80.125mm\nX=13.0mm Y=-3.5mm Z=81.0625mm\nX=14.75mm Y=0.00015mm Z=79.5mm",
    "units apart": "12.5 mm; -3.25 mm; 80.125 mm\n13.0 mm; -3.5 mm; 81.0625 mm\n14.75 mm; 0.00015 mm; 79.5 mm\n",
    "units apart, blanks, decimal commas": (
        "12,5 mm -3,25 mm 80,125 mm\n13,0 mm -3,5 mm 81,0625 mm\n14,75 mm 0,00015 mm 79,5 mm"
    ),
    "brackets": "P1 (12.5, -3.25, 80.125)\nP2 (13.0, -3.5, 81.0625)\nP3 (14.75, 0.00015, 79.5)\n",
    "fixed width": "  12.50000 -3.25000  80.12500\n  13.00000 -3.50000  81.06250\n  14.75000  0.00015  79.50000\n",
    "fixed width, no blank left": "12.500-3.250000  80.1250\n13.000-3.500000  81.0625\n14.750+0.000150  79.5000\n",
    "a remark behind": "12.5 -3.25 80.125 ! row 1\n13.0 -3.5 81.0625\n14.75 0.00015 79.5 # 2 of 3\n",
    "statements": (
        "F(P1)=FEAT/POINT,CART,12.5,-3.25,80.125\nF(P2)=FEAT/POINT,CART,13.0,-3.5,81.0625\n"
        "F(P3)=FEAT/POINT,CART,14.75,0.00015,79.5\n"
    ),
    "lines of a program": "N10 X12.5 Y-3.25 Z80.125\nN20 X13.0 Y-3.5 Z81.0625\nN30 X14.75 Y0.00015 Z79.5\nM30\n",
    "rows announced": (
        "Flank: concave\nRow 1\n 1: 12.5 -3.25 80.125\n\nRow 2\n 1: 13.0 -3.5 81.0625\n 2: 14.75 0.00015 79.5\n"
    ),
    "quoted": '"12.5";"-3.25";"80.125"\n"13.0";"-3.5";"81.0625"\n"14.75";"0.00015";"79.5"\n',
    "a deviation behind": "12.5 -3.25 80.125 0.004\n13.0 -3.5 81.0625 0.002\n14.75 0.00015 79.5 -0.003\n",
    "measured beside nominal, named": (
        "No;X_nom;Y_nom;Z_nom;X_act;Y_act;Z_act;Dev\n1;12.4;-3.2;80.1;12.5;-3.25;80.125;0.1\n"
        "2;13.1;-3.4;81.1;13.0;-3.5;81.0625;0.1\n3;14.7;0.1;79.6;14.75;0.00015;79.5;0.1\n"
    ),
    "another order, named": "z,x,y\n80.125,12.5,-3.25\n81.0625,13.0,-3.5\n79.5,14.75,0.00015\n",
}
WITH_NORMALS = {
    "blanks": "12.5 -3.25 80.125 0.6 0.8 0\n13.0 -3.5 81.0625 0 0.6 -0.8\n14.75 0.00015 79.5 1 0 0\n",
    "named, semicolons": (
        "x;y;z;nx;ny;nz\n12.5;-3.25;80.125;.6;.8;0\n13.0;-3.5;81.0625;0;.6;-.8\n14.75;0.00015;79.5;1;0;0\n"
    ),
    "named with units": (
        "x [mm], y [mm], z [mm], i, j, k\n12.5,-3.25,80.125,.6,.8,0\n13.0,-3.5,81.0625,0,.6,-.8\n"
        "14.75,0.00015,79.5,1,0,0\n"
    ),
    "numbered, deviation behind": (
        "1 12.5 -3.25 80.125 .6 .8 0 .01\n2 13.0 -3.5 81.0625 0 .6 -.8 .02\n3 14.75 0.00015 79.5 1 0 0 .03\n"
    ),
    "normals first": ".6 .8 0 12.5 -3.25 80.125\n0 .6 -.8 13.0 -3.5 81.0625\n1 0 0 14.75 0.00015 79.5\n",
}


def written(tmp_path, text, encoding="utf-8"):
    path = tmp_path / "p.txt"
    path.write_bytes(text.encode(encoding))
    return path


@pytest.mark.parametrize("text", LAYOUTS.values(), ids=LAYOUTS)
def test_the_same_points_are_read_from_every_layout(tmp_path, text):
    found = read_point_text(written(tmp_path, text))
    assert found.point.tolist() == POINTS
    assert found.normal is None


@pytest.mark.parametrize("text", WITH_NORMALS.values(), ids=WITH_NORMALS)
def test_normals_are_told_from_other_columns(tmp_path, text):
    found = read_point_text(written(tmp_path, text))
    assert found.point.tolist() == POINTS
    np.testing.assert_allclose(found.normal, NORMALS, atol=1e-15)


@pytest.mark.parametrize("encoding", ["utf-16", "latin-1"])
def test_texts_of_older_and_of_other_systems_are_read(tmp_path, encoding):
    found = read_point_text(written(tmp_path, "Größe in µm\n" + LAYOUTS["blanks"], encoding))
    assert found.point.tolist() == POINTS


def test_inches_become_millimetres(tmp_path):
    found = read_point_text(written(tmp_path, LAYOUTS["blanks"]), "inch")
    np.testing.assert_allclose(found.point[0], [317.5, -82.55, 2035.175], rtol=1e-15)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", r"holds no row of three numbers, x y z$"),
        ("Part 4711\nno points today\n", r"holds no row of three numbers"),
        (LAYOUTS["blanks"] + "15.0 -3.\n", r"line 4: has 2 numbers, the rows above have 3: '15.0 -3.'$"),
        (
            "1.234 2.345 3.456\n" * 3 + "1.334 2.345 3.4",
            r"line 4: its last number has 1 decimals, those above have 3: .* cut off",
        ),
        ("1.5 2.5 3.5\n" + "1.5 2.5 3.5 0 0 1\n" * 4, r"line 1: has 3 numbers, the rows below have 6"),
        (
            "".join(f"1.5 2.5 {k}.5 0 0 2\n" for k in range(5)),
            r"the normals in columns 4 to 6 have length 2: must be 1",
        ),
        (
            LAYOUTS["blanks"] + "Mean 12.3 45.6 78.9\n",
            r"line 4: has its numbers in columns 2, 3, 4, the rows above have them in 1, 2, 3: 'Mean 12.3 45.6 78.9'$",
        ),
        (LAYOUTS["blanks"] + "15.0 ***** 80.0\n", r"line 4: has 2 numbers, the rows above have 3"),
        (LAYOUTS["blanks"] + "15.0 nan 80.0\n", r"line 4: nan: must be a number, at most 100000 in size$"),
        (LAYOUTS["blanks"] + "15.0 1e30 80.0\n", r"line 4: 1e\+30: must be a number"),
        (
            "Number of points: 45\n" + LAYOUTS["blanks"],
            r"holds 3 points, and says 'Number of points: 45': is it whole\?$",
        ),
        ("# 9 points\n" + LAYOUTS["blanks"], r"holds 3 points, and says '# 9 points'"),
        ("x;y;z;nx;ny;nz\n1.5;2.5;3.5;.6;.6;0\n", r"a normal has length 0\.8485: must be 1$"),
        ("1.5 2.5 3.5 1.51 2.52 3.49\n2.5 3.5 4.5 2.51 3.5 4.5\n", r"columns 4 to 6 look like points too"),
    ],
)
def test_what_is_not_whole_is_refused_with_its_line(tmp_path, text, sentence):
    with pytest.raises(InputError, match=sentence):
        read_point_text(written(tmp_path, text))


def test_binary_and_absent_files_are_refused(tmp_path):
    (tmp_path / "p.bin").write_bytes(b"solid\0\1\2")
    with pytest.raises(InputError, match=r"p\.bin: is no text file: byte 5 is zero$"):
        read_point_text(tmp_path / "p.bin")
    with pytest.raises(InputError, match=r"absent\.txt: cannot be read"):
        read_point_text(tmp_path / "absent.txt")
