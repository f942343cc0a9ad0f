/*
 * Axis positions of the vertical machine along the roll of one flank, and what a refusal looks like.
 *
 *     cc -std=c99 axes.c $(pkg-config --cflags --libs gearmath) -lm
 */
#include <stdio.h>

#include "gearmath.h"

#define NODES 9

/* The concave flank of the pinion of NASA TP-3096, 12 x 36 teeth, in mm and rad. */
static const double settings[12] = {
    74.874171554126, -1.1159989619985908, 0.0, 0.0, 3.9262277584, 0.296487393552, 1.021857658688,
    0.2943788667042891, 3.2426985355495, 0.0, 75.326783002724, 0.31495635289994856};
static const double on_the_axis[3] = {0.0, 0.0, 0.0};

int main(void)
{
  const double pivot_height = 500.0; /* R_d + C_t */
  double theta[NODES], axes[NODES][5];
  int64_t first_bad;
  int status, k;

  if (gm_abi_version() != GM_ABI_VERSION) {
    fprintf(stderr, "header and library do not belong together\n");
    return 1;
  }
  for (k = 0; k < NODES; ++k) theta[k] = -0.16 + 0.04 * k;
  status = gm_axis_transform_batch(
      NODES, settings, 0, theta, 1, &pivot_height, 0, on_the_axis, 0, &axes[0][0], &first_bad);
  if (status != GM_OK) {
    fprintf(stderr, "node %d: %s\n", (int)first_bad, gm_error_text(status));
    return 1;
  }
  for (k = 0; k < NODES; ++k)
    printf("theta %+.2f  X %.5f Y %.5f Z %.5f A %.7f B %.7f\n", theta[k], axes[k][0], axes[k][1], axes[k][2],
        axes[k][3], axes[k][4]);

  theta[4] = 100.0; /* no roll goes so far */
  status = gm_axis_transform_batch(
      NODES, settings, 0, theta, 1, &pivot_height, 0, on_the_axis, 0, &axes[0][0], &first_bad);
  printf("node %d refused: %s\n", (int)first_bad, gm_error_text(status));
  return status == GM_E_DOMAIN && first_bad == 4 ? 0 : 1;
}
