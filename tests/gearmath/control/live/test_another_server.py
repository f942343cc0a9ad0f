"""A control of another release: the copy methods in their newer home, no encryption, users by certificate or none.

It is looked at with asyncua's own client and file classes, which know nothing of ours.
"""

from __future__ import annotations

import asyncio
from typing import Any

import pytest
from asyncua import Client, ua
from asyncua.client.ua_file import UaFile

from gearmath.control import sinumerik
from gearmath.control.opcua import OpcUaControl
from gearmath.control.simulated.access import Access, Account
from gearmath.control.simulated.identity import prepared
from gearmath.control.simulated.nc import Nc, NcJob
from gearmath.control.simulated.server import Appearance, SimulatedControl
from gearmath.errors import ComputationError
from gearmath.specs.control_connection import ControlConnection, load_control_connection


class _Nothing:
    def job(self, text: str, name: str, number: int) -> NcJob:
        return NcJob()


@pytest.mark.slow
def test_a_newer_server_without_encryption_and_with_users_by_certificate(tmp_path: Any) -> None:
    async def work() -> None:
        identity = await prepared(tmp_path, "opc.tcp://127.0.0.1:4840")
        own = (tmp_path / "client.der").read_bytes()
        access = Access({"operator": Account("p1"), "machine 7": Account(certificate=own)}, anonymous=True)
        nc = Nc(_Nothing(), 0.0)
        async with SimulatedControl(nc, access, identity, Appearance(("new",), unencrypted=True)) as control:
            plain = ControlConnection(name="plain", url=control.url, user="operator", security="none")
            await _files_in_the_newer_home(plain, nc)
            await _by_certificate(tmp_path, control.url)
            await _nobody(control.url)
            await _with_the_classes_of_the_library(control.url)

    asyncio.run(asyncio.wait_for(work(), 120))


async def _files_in_the_newer_home(known: ControlConnection, nc: Nc) -> None:
    one = await OpcUaControl.connect(known, "p1", [sinumerik.READ_FILES, sinumerik.WRITE_FILES])
    await one.put("AB.MPF", b"M30\n")
    await one.put("CD.SPF", b"RET\n")
    assert nc.files == {"Part Program/AB.MPF": b"M30\n", "Sub Program/CD.SPF": b"RET\n"}
    assert await one.get("CD.SPF") == b"RET\n"
    await one.close()


async def _by_certificate(folder: Any, url: str) -> None:
    """No user name: the certificate says who it is, here another user than that of the password."""
    known = load_control_connection(folder / "control.toml").model_copy(update={"url": url, "user": ""})
    one = await OpcUaControl.connect(known, "", [sinumerik.READ_STATE])
    assert (await one.status()).channel == "reset"
    await one.close()


async def _nobody(url: str) -> None:
    """A session without a name may look at values and call nothing."""
    async with Client(url) as client:
        assert await client.get_node("ns=2;s=/Channel/Parameter/R[u1,1]").read_value() == 0.0
        with pytest.raises(ua.UaStatusCodeError) as error:
            await client.get_node("ns=2;s=/Methods").call_method("2:GetMyAccessRights")
        assert error.value.code == ua.StatusCodes.BadRequestNotAllowed
        with pytest.raises(ua.UaStatusCodeError) as error:
            await client.get_node("ns=2;s=/Channel/Parameter/R[u1,1]").write_value(1.0)
        assert error.value.code == ua.StatusCodes.BadUserAccessDenied
    with pytest.raises(ComputationError):
        await OpcUaControl.connect(ControlConnection(name="x", url=url, user="x", security="none"), "")


async def _with_the_classes_of_the_library(url: str) -> None:
    client = Client(url)
    client.set_user("operator")
    client.set_password("p1")
    async with client:
        root = await client.nodes.objects.get_child("2:Sinumerik")
        file = await root.get_child(["2:FileSystem", "2:Part Program", "2:AB.MPF"])
        async with UaFile(file, "r") as opened:
            assert await opened.read() == b"M30\n"
        first = await root.get_child(["2:Channel", "2:Parameter", "2:R[u1,1]"])
        await first.write_value(2.5)
        assert await first.read_value() == 2.5
        assert await first.read_data_type_as_variant_type() == ua.VariantType.Double
        message = await root.get_child(["2:Channel", "2:ProgramInfo", "2:msg[u1]"])
        assert await message.read_data_type_as_variant_type() == ua.VariantType.String
