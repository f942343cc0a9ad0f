/* gm_store.c: records of the EEPROM, little-endian: 'G' 'M', version, fields, zeros, and the CRC-32 at the end. */
#include "gm_store.h"

enum { GM_VERSION = 2, GM_CRC_AT = GM_RECORD_BYTES - 4 };

uint32_t gm_crc32(const uint8_t *bytes, int count) {
  uint32_t crc = UINT32_C(0xffffffff);
  int k, bit;
  for (k = 0; k < count; ++k) {
    crc ^= bytes[k];
    for (bit = 0; bit < 8; ++bit) {
      crc = (crc >> 1) ^ (crc & 1 ? UINT32_C(0xedb88320) : 0);
    }
  }
  return ~crc;
}

static void gm_put32(uint8_t *at, uint32_t value) {
  int k;
  for (k = 0; k < 4; ++k) {
    at[k] = (uint8_t)(value >> (8 * k));
  }
}

static uint32_t gm_get32(const uint8_t *at) {
  return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static void gm_pack(const gm_settings *settings, uint32_t sequence, uint8_t record[GM_RECORD_BYTES]) {
  int k;
  for (k = 0; k < GM_RECORD_BYTES; ++k) {
    record[k] = 0;
  }
  record[0] = 'G';
  record[1] = 'M';
  record[2] = GM_VERSION;
  record[3] = settings->profile;
  gm_put32(record + 4, sequence);
  record[8] = settings->hob_unit;
  record[9] = settings->depth_rule;
  record[10] = (uint8_t)(settings->starts + 128);
  record[11] = settings->left;
  record[12] = settings->climb;
  record[13] = settings->pitch_kind;
  gm_put32(record + 16, (uint32_t)settings->teeth | (uint32_t)settings->helix << 16);
  gm_put32(record + 20, (uint32_t)settings->hob_size);
  gm_put32(record + 24, (uint32_t)settings->pitch);
  gm_put32(record + 28, (uint32_t)settings->feed);
  gm_put32(record + GM_CRC_AT, gm_crc32(record, GM_CRC_AT));
}

/* 0, or -1 where the record is damaged, of another version, or holds what no operator can set. */
static int gm_unpack(const uint8_t record[GM_RECORD_BYTES], gm_settings *settings, uint32_t *sequence) {
  gm_settings read;
  if (record[0] != 'G' || record[1] != 'M' || record[2] != GM_VERSION ||
      gm_get32(record + GM_CRC_AT) != gm_crc32(record, GM_CRC_AT)) {
    return -1;
  }
  read.profile = record[3];
  read.hob_unit = record[8];
  read.depth_rule = record[9];
  read.starts = (int8_t)(record[10] - 128);
  read.left = record[11];
  read.climb = record[12];
  read.pitch_kind = record[13];
  read.teeth = (uint16_t)(gm_get32(record + 16) & 0xffff);
  read.helix = (uint16_t)(gm_get32(record + 16) >> 16);
  read.hob_size = (int32_t)(gm_get32(record + 20) & INT32_MAX);
  read.pitch = (int32_t)(gm_get32(record + 24) & INT32_MAX);
  read.feed = (int32_t)(gm_get32(record + 28) & INT32_MAX);
  if (gm_settings_check(&read) != GM_JOB_OK) {
    return -1;
  }
  *settings = read;
  *sequence = gm_get32(record + 4);
  return 0;
}

int gm_store_load(const uint8_t image[GM_STORE_BYTES], gm_settings *settings, uint32_t *sequence) {
  gm_settings read;
  uint32_t number, newest = 0;
  int slot, best = -1;
  for (slot = 0; slot < GM_STORE_SLOTS; ++slot) {
    /* the difference decides, so that the number may run over */
    if (gm_unpack(image + slot * GM_RECORD_BYTES, &read, &number) == 0 &&
        (best < 0 || (uint32_t)(number - newest) < UINT32_C(0x80000000))) {
      best = slot;
      newest = number;
      *settings = read;
      *sequence = number;
    }
  }
  return best;
}

int gm_store_save(uint8_t image[GM_STORE_BYTES], const gm_settings *settings) {
  gm_settings last;
  uint32_t sequence = UINT32_MAX;
  const int newest = gm_store_load(image, &last, &sequence);
  const int slot = newest < 0 ? 0 : (newest + 1) % GM_STORE_SLOTS;
  if (gm_settings_check(settings) != GM_JOB_OK) {
    return -1;
  }
  gm_pack(settings, sequence + 1, image + slot * GM_RECORD_BYTES);
  return slot;
}
