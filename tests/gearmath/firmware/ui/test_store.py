"""The last job in the EEPROM: checked, and never lost to a power cut."""

from __future__ import annotations

import ctypes
import zlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

RECORD, SLOTS = 40, 2


@pytest.fixture(scope="session")
def library(firmware):
    made = firmware("hobbing_plewes")
    made.gm_crc32.restype = ctypes.c_uint32
    return made


@pytest.fixture
def image():
    """An EEPROM as it leaves the factory."""
    return (ctypes.c_uint8 * (RECORD * SLOTS))(*[0xFF] * (RECORD * SLOTS))


@pytest.fixture
def load(library, new_settings):
    def call(image):
        read, sequence = new_settings(teeth=999), ctypes.c_uint32()
        return library.gm_store_load(image, ctypes.byref(read), ctypes.byref(sequence)), read.values()

    return call


def test_crc_has_the_published_check_value(library):
    assert library.gm_crc32(b"123456789", 9) == 0xCBF43926


@given(st.binary(max_size=60))
def test_crc_is_that_of_zip(library, data):
    assert library.gm_crc32(data, len(data)) == zlib.crc32(data)


def test_an_empty_eeprom_holds_no_job_and_leaves_the_settings_alone(image, load, new_settings):
    assert load(image) == (-1, new_settings(teeth=999).values())


def test_slots_are_written_in_turn_and_the_newest_counts(library, image, load, new_settings):
    for k in range(7):
        job = new_settings(teeth=20 + k, starts=-1 - k % 3, helix=100 * k, left=k % 2, climb=1, feed=10 + k)
        assert library.gm_store_save(image, ctypes.byref(job)) == k % 2
        assert load(image) == (k % 2, job.values())


@pytest.mark.parametrize("place", range(RECORD))
@pytest.mark.parametrize("flip", [0x01, 0x80, 0xFF])
def test_a_changed_byte_brings_back_the_record_before(library, image, load, new_settings, place, flip):
    before, last = new_settings(teeth=30), new_settings(teeth=31)
    library.gm_store_save(image, ctypes.byref(before))
    library.gm_store_save(image, ctypes.byref(last))
    image[RECORD + place] ^= flip
    assert load(image) == (0, before.values())


def test_a_power_cut_after_any_byte_keeps_the_last_job_or_has_the_new_one(library, image, load, new_settings):
    old, new = new_settings(teeth=40), new_settings(teeth=41)
    for job in (new_settings(teeth=39), old):
        library.gm_store_save(image, ctypes.byref(job))
    after = type(image)(*image)
    slot = library.gm_store_save(after, ctypes.byref(new))
    for written in range(RECORD + 1):
        torn = type(image)(*image)
        for k in range(slot * RECORD, slot * RECORD + written):
            torn[k] = after[k]
        read = load(torn)[1]
        assert read == (old.values() if read[7] == 40 else new.values())
        assert (written < RECORD) <= (read == old.values() or torn[:] == after[:])


def test_the_number_of_a_record_may_run_over(library, image, load, new_settings):
    for k in range(3):
        job = new_settings(teeth=50 + k)
        slot = library.gm_store_save(image, ctypes.byref(job))
        if k == 0:  # as after 2^32 - 1 saves
            record = bytearray(image[slot * RECORD : (slot + 1) * RECORD])
            record[4:8] = b"\xff\xff\xff\xff"
            record[36:40] = zlib.crc32(bytes(record[:36])).to_bytes(4, "little")
            image[slot * RECORD : (slot + 1) * RECORD] = record
        assert load(image)[1] == job.values()


@pytest.mark.parametrize("bad", [{"teeth": 0}, {"starts": 0}, {"helix": 6001}, {"hob_size": 0}, {"profile": 1}])
def test_what_no_operator_can_set_is_neither_written_nor_read(library, image, load, new_settings, bad):
    job = new_settings(**bad)
    assert library.gm_store_save(image, ctypes.byref(job)) == -1
    assert image[:] == [0xFF] * RECORD * SLOTS
    library.gm_store_save(image, ctypes.byref(new_settings()))
    record = bytearray(image[:RECORD])
    record[16:18] = b"\0\0"  # teeth 0 with a valid CRC
    record[36:40] = zlib.crc32(bytes(record[:36])).to_bytes(4, "little")
    image[:RECORD] = record
    assert load(image)[0] == -1
