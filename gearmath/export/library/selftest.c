/*
 * selftest: whether libgearmath computes on this computer what the design programs compute.
 *
 * Every function runs on the vectors of selftest_vectors.h, one point at a time, as a batch, and with an input that must
 * be refused. The sine of another C library may differ in its last bit; so numbers must agree within GM_TEST_TOLERANCE,
 * and the program says how many are the same bit for bit. Ends with status 0 where everything agrees.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "gearmath.h"

static int failures, numbers, same_bits;
static double worst;

static void failed(const char *name, const char *what)
{
  ++failures;
  printf("%s: %s\n", name, what);
}

static void compare(const char *name, const double *ours, const double *expected, int n, double tolerance)
{
  int k, bad = 0;
  for (k = 0; k < n; ++k) {
    const double size = fabs(expected[k]) > 1.0 ? fabs(expected[k]) : 1.0;
    const double off = fabs(ours[k] - expected[k]) / size;
    if (!(off <= tolerance)) bad = 1;
    if (off > worst) worst = off;
    same_bits += memcmp(ours + k, expected + k, sizeof *ours) == 0;
  }
  numbers += n;
  if (bad) failed(name, "deviates from the design programs");
}

static void expect(const char *name, int status, int expected)
{
  if (status != expected) {
    failed(name, gm_error_text(status));
    printf("  expected: %s\n", gm_error_text(expected));
  }
}

static void refused(const char *name, const double *outputs, int n)
{
  int k;
  for (k = 0; k < n; ++k)
    if (!isnan(outputs[k])) {
      failed(name, "an output of a refused point is not NaN");
      return;
    }
}

#include "selftest_vectors.h"

int main(void)
{
  if (gm_abi_version() != GM_ABI_VERSION) failed("gm_abi_version", "header and library do not belong together");
  run_vectors();
  printf("libgearmath %s, interface %d: %d numbers, %d the same bit for bit, the others within %.1e\n", gm_version(),
      gm_abi_version(), numbers, same_bits, worst);
  if (failures) printf("%d failures\n", failures);
  return failures != 0;
}
