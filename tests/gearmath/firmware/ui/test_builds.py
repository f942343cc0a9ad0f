"""The operator's part is plain C99 and C++, and runs clean under the sanitizers."""

from __future__ import annotations

import shutil
import subprocess

import pytest

from gearmath.errors import ComputationError

MACHINES = ["hobbing_plewes", "hobbing_metric", "hobbing_helical", "lathe_example"]
STRICT = ("-pedantic", "-Wall", "-Wextra", "-Werror")


@pytest.mark.parametrize("machine", MACHINES)
def test_random_events_run_clean_under_the_sanitizers(machine, build_firmware):
    flags = ("-std=c99", *STRICT, "-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    try:
        program = build_firmware(machine, *flags)
    except ComputationError as error:
        if "san" in str(error) and "cannot find" in str(error):
            pytest.skip("the C compiler has no sanitizers")
        raise
    done = subprocess.run([program], capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("machine", MACHINES)
def test_it_is_also_cxx(machine, build_firmware):
    if shutil.which("g++") is None:
        pytest.skip("g++ is not installed")
    program = build_firmware(machine, "-x", "c++", "-std=c++11", *STRICT, "-O1", "-lstdc++")
    assert subprocess.run([program], timeout=120).returncode == 0


@pytest.mark.parametrize("machine", MACHINES)
def test_there_is_no_floating_point(machine, build_firmware):
    program = build_firmware(machine, "-std=c99", *STRICT, "-Os", "-Dfloat=refused", "-Ddouble=refused")
    assert subprocess.run([program], timeout=120).returncode == 0
