/* gm_store.h: the parameters of the last job as bytes for the EEPROM; never a phase, which does not survive the power.
 *
 * Two slots are written in turn. A record counts only with its magic, its version and its CRC-32, so that a power cut
 * during a write leaves the record before it. The bytes do not depend on the compiler or the processor.
 */
#ifndef GM_STORE_H
#define GM_STORE_H

#include "gm_job.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { GM_RECORD_BYTES = 40, GM_STORE_SLOTS = 2, GM_STORE_BYTES = GM_RECORD_BYTES * GM_STORE_SLOTS };

/* CRC-32 of ISO 3309 (zip, Ethernet); of "123456789" it is CBF43926. */
uint32_t gm_crc32(const uint8_t *bytes, int count);
/* The newest valid record of the image; its slot, or -1 where none is valid (settings and sequence then unchanged). */
int gm_store_load(const uint8_t image[GM_STORE_BYTES], gm_settings *settings, uint32_t *sequence);
/* Puts the record beside the newest one. The slot whose GM_RECORD_BYTES must be written, or -1 for refused settings. */
int gm_store_save(uint8_t image[GM_STORE_BYTES], const gm_settings *settings);

#ifdef __cplusplus
}
#endif

#endif
