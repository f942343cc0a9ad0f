component gm_axes "Axis positions of a vertical bevel gear machine at a cradle rotation.";
description """
From this folder's parent, where gearmath.h is:

    halcompile --compile examples/linuxcnc/gm_axes.comp

(or --install). The parameters are the settings of one flank, the pin theta the cradle rotation; x, y, z, a, b follow in
every cycle of the thread. status is that of the library: 0, or why the positions stay where they were.
""";
pin in float theta "cradle rotation, rad";
pin out float x "mm";
pin out float y "mm";
pin out float z "mm";
pin out float a "rad";
pin out float b "rad";
pin out s32 status "0, or a GM_E_ code";
param rw float settings-##[12] "settings of one flank, as in gm_axis_transform.h";
param rw float pivot_height "R_d + C_t, mm";
function _ fp "computes the positions";
include "gm_axis_transform.c";
license "MIT";
;;
FUNCTION(_)
{
  const double on_the_axis[3] = {0.0, 0.0, 0.0};
  double given[12], axes[5];
  int k;
  for (k = 0; k < 12; ++k) given[k] = settings(k);
  status = gm_axis_transform(given, theta, pivot_height, on_the_axis, axes);
  if (status != GM_OK) return;
  x = axes[0];
  y = axes[1];
  z = axes[2];
  a = axes[3];
  b = axes[4];
}
