/* gm_status: version and sentences of libgearmath. */
#include "gm_status.h"
#include "gm_version.h"

int gm_abi_version(void)
{
  return GM_ABI_VERSION;
}

const char *gm_version(void)
{
  return GM_VERSION;
}

const char *gm_error_text(int status)
{
  switch (status) {
  case GM_OK: return "no error";
  case GM_E_NULL: return "a pointer is null";
  case GM_E_SIZE: return "a number of points or a stride is negative";
  case GM_E_DOMAIN: return "an input is not a number, or outside the range that the header states";
  case GM_E_REQUIRES: return "a requirement of the header does not hold, as at a singular pose";
  case GM_E_NO_RESULT: return "there is no finite result for these inputs";
  default: return "no status of this library";
  }
}
