"""The client against the simulated control, over an encrypted session on loopback."""

from __future__ import annotations

import asyncio
import hashlib
import itertools
import random
import statistics
from datetime import timedelta
from typing import Any

import pytest
from asyncua import Client, ua

from gearmath.control import sinumerik
from gearmath.control.interface import ConnectionLost, NoSession
from gearmath.control.opcua import OpcUaControl
from gearmath.control.simulated.nc import NcAlarm
from gearmath.errors import ComputationError, InputError


def run(work: Any) -> Any:
    return asyncio.run(asyncio.wait_for(work, 60))


def test_parameters_that_are_written_are_those_of_the_control_and_are_read_back_in_the_order_asked_for(
    live: Any,
) -> None:
    async def work() -> list[float]:
        control = await live.connect(sinumerik.READ_STATE, sinumerik.WRITE_STATE)
        await control.write_parameters({10: 2.5, 11: -1e-7, 400: 99_999_999.0})
        found = await control.read_parameters([400, 10, 12, 11])
        await control.close()
        return found

    assert run(work()) == [99_999_999.0, 2.5, 0.0, -1e-7]
    assert (live.nc.parameters[10], live.nc.parameters[11]) == (2.5, -1e-7)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({103: 1.0}, "handshake"),
        ({101: 1.0}, "handshake"),
        ({1: float("nan")}, "must be a number"),
        ({1: 1e9}, "must be a number"),
        ({1000: 1.0}, "0 to 999"),
        ({-1: 1.0}, "0 to 999"),
    ],
)
def test_what_only_the_handshake_writes_and_what_no_parameter_holds_is_refused(
    live: Any, values: dict, said: str
) -> None:
    async def work() -> None:
        control = await live.connect()
        try:
            await control.write_parameters(values)
        finally:
            await control.close()

    with pytest.raises(InputError, match=said):
        run(work())


def test_status_says_channel_mode_program_message_and_position(live: Any) -> None:
    live.load()
    live.nc.message = "clean the work\nand go on"
    live.nc.position = [1.0, -2.0, 3.0, 40.0, -5.0]

    async def work() -> Any:
        control = await live.connect(sinumerik.READ_STATE)
        found = await control.status()
        await control.close()
        return found

    status = run(work())
    assert (status.channel, status.mode, status.selected) == ("reset", "automatic", "TEN.MPF")
    assert status.position == (1.0, -2.0, 3.0, 40.0, -5.0)
    assert status.message == "clean the work and go on"


def test_alarms_come_from_sinumerik_each_once_and_go(live: Any) -> None:
    async def work() -> tuple[list, list, list]:
        live.nc.raise_alarm(NcAlarm("10203", "channel 1 reference point", 500))
        control = await live.connect(sinumerik.READ_ALARMS)
        before = await control.alarms()
        live.nc.raise_alarm(NcAlarm("65001", "touched nothing"))
        await asyncio.sleep(0.4)
        both = await control.alarms()
        await asyncio.to_thread(live.nc.reset)
        await asyncio.sleep(0.4)
        after = await control.alarms()
        await control.close()
        return before, both, after

    before, both, after = run(work())
    assert [(alarm.number, alarm.severity) for alarm in before] == [("10203", 500)]
    assert [alarm.number for alarm in both] == ["10203", "65001"]
    assert both[1].text == "touched nothing"
    assert after == []


def test_who_listens_to_server_only_misses_the_alarm(live: Any) -> None:
    """Written with the library alone: on this control the events hang on the object Sinumerik."""
    heard: dict[str, list[str]] = {"server": [], "sinumerik": []}

    class Listener:
        def __init__(self, place: str) -> None:
            self.place = place

        def event_notification(self, event: Any) -> None:
            heard[self.place].append(event.Message.Text)

    async def work() -> None:
        ours = await live.connect()
        client = ours._client
        root = client.get_node("ns=2;s=Sinumerik")
        for place, node in (("server", client.nodes.server), ("sinumerik", root)):
            subscription = await client.create_subscription(100, Listener(place))
            await subscription.subscribe_events(node)
        live.nc.raise_alarm(NcAlarm("3000", "Emergency stop"))
        await asyncio.sleep(0.5)
        await ours.close()

    run(work())
    assert heard["sinumerik"] == ["Emergency stop"]
    assert heard["server"] == []


@pytest.mark.parametrize("name", ["R[u1,7]", "R[u1, 7]", "R[7]", "r[u1,7]"])
def test_every_spelling_of_a_parameter_that_was_met_is_the_same_one(live: Any, name: str) -> None:
    live.nc.parameters[7] = 1.25

    async def work() -> float:
        ours = await live.connect()
        value = await ours._client.get_node(f"ns=2;s=/Channel/Parameter/{name}").read_value()
        await ours.close()
        return value

    assert run(work()) == 1.25


def test_variables_are_not_browsed_to_beyond_the_first_and_a_missing_one_has_the_code_of_the_control(live: Any) -> None:
    async def work() -> tuple[list[str], int]:
        ours = await live.connect()
        client = ours._client
        area = client.get_node("ns=2;s=/Channel/Parameter")
        names = [(await one.read_browse_name()).Name for one in await area.get_children()]
        try:
            await client.get_node("ns=2;s=/Channel/Parameter/NONE[u1,1]").read_value()
        except ua.UaStatusCodeError as error:
            code = error.code
        await ours.close()
        return names, code

    assert run(work()) == (["R[u1,1]"], ua.StatusCodes.BadAttributeIdInvalid)


@pytest.mark.parametrize("megabytes", [3, 20])
def test_a_program_goes_up_and_down_unchanged(live: Any, megabytes: int) -> None:
    """3 MB by the copy methods, 20 MB in parts by the file object: the copy methods take 16 MB."""
    content = random.Random(megabytes).randbytes(megabytes * 1_000_000)

    async def work() -> bytes:
        control = await live.connect(sinumerik.READ_FILES, sinumerik.WRITE_FILES, seconds=10.0)
        await control.put("BIG.MPF", content)
        with pytest.raises(ComputationError, match="such a file already"):
            await control.put("BIG.MPF", b"M30\n" if megabytes < 16 else content)
        found = await control.get("BIG.MPF")
        await control.put("BIG.MPF", b"M30\n", replace=True)
        await control.close()
        return found

    found = run(work())
    assert hashlib.sha256(found).digest() == hashlib.sha256(content).digest()
    assert live.nc.files["Part Program/BIG.MPF"] == b"M30\n"


@pytest.mark.parametrize(
    "name",
    [
        "../AB.MPF",
        "..\\AB.MPF",
        "/etc/passwd",
        "\\\\server\\share\\AB.MPF",
        "C:\\AB.MPF",
        "AB.MPF.MPF",
        "A" * 300 + ".MPF",
        "AB\x00.MPF",
        "AB\n.MPF",
        "A\u0130B.MPF",
        "CON.MPF",
        "LPT1.SPF",
        "AB.TXT",
        "",
        ".",
        "Part Program/AB.MPF",
        "1A.MPF",
    ],
)
def test_names_that_lead_out_of_a_folder_or_that_the_control_refuses_are_refused_here(live: Any, name: str) -> None:
    async def work() -> None:
        control = await live.connect()
        with pytest.raises(InputError, match="file name"):
            await control.get(name)
        with pytest.raises(InputError, match="file name"):
            await control.put(name, b"M30\n")
        await control.close()

    run(work())
    assert live.nc.files == {}


def test_the_selected_program_and_an_active_channel_are_not_written_to(live: Any) -> None:
    live.load()
    live.nc.parameters[104] = 1.0

    async def work() -> list[str]:
        said = []
        control = await live.connect()
        for name in ("TEN.MPF", "ten.mpf"):
            with pytest.raises(ComputationError) as error:
                await control.put(name, b"M30\n", replace=True)
            said.append(str(error.value))
        live.nc.start()  # it waits for a host at its first point
        await asyncio.sleep(0.1)
        with pytest.raises(ComputationError) as error:
            await control.put("OTHER.MPF", b"M30\n")
        said.append(str(error.value))
        await control.close()
        return said

    first, again, active = run(work())
    assert "it is the selected program" in first
    assert "it is the selected program" in again
    assert "the channel is active" in active
    assert list(live.nc.files) == ["Part Program/TEN.MPF"]


def test_a_missing_right_is_named_before_anything_is_done(live: Any) -> None:
    for right in (sinumerik.READ_STATE, sinumerik.WRITE_STATE, sinumerik.READ_ALARMS, sinumerik.READ_FILES):
        live.control.access.accounts["operator"].rights = live.rights - {right}
        with pytest.raises(ComputationError, match=f"lacks the right {right}") as error:
            run(live.connect(right))
        assert "\n" not in str(error.value)


def test_rights_for_all_of_a_kind_are_enough_and_are_never_needed(live: Any) -> None:
    live.control.access.accounts["operator"].rights = frozenset({"SinuReadAll"})

    async def work() -> None:
        control = await live.connect(sinumerik.READ_STATE, sinumerik.READ_FILES, sinumerik.READ_ALARMS)
        await control.status()
        with pytest.raises(ComputationError, match=sinumerik.WRITE_STATE):
            await control.write_parameters({1: 1.0})
        await control.close()

    run(work())


def test_without_the_protection_level_files_are_not_written(live: Any) -> None:
    live.control.access.operate = False

    async def work() -> None:
        control = await live.connect()
        with pytest.raises(ComputationError, match="protection level"):
            await control.put("AB.MPF", b"M30\n")
        await control.close()

    run(work())


@pytest.mark.parametrize("user", ["operator", "nobody"])
def test_a_wrong_password_or_user_is_one_sentence(live: Any, user: str) -> None:
    known = live.connection.model_copy(update={"user": user})
    with pytest.raises(ComputationError, match="user or password is wrong") as error:
        run(OpcUaControl.connect(known, "wrong"))
    assert "wrong" not in str(error.value).replace("password is wrong", "")


def test_a_certificate_that_the_control_does_not_know_is_refused(live: Any, tmp_path: Any) -> None:
    from cryptography.x509.oid import ExtendedKeyUsageOID

    from gearmath.control.login import APPLICATION_URI
    from gearmath.control.simulated.identity import made

    key, certificate = tmp_path / "key.pem", tmp_path / "other.der"
    run(made(key, certificate, APPLICATION_URI, ExtendedKeyUsageOID.CLIENT_AUTH))
    with pytest.raises(ComputationError, match=r"other\.der is unknown: add it to the control's trust list"):
        run(live.connect(certificate=str(certificate), key=str(key)))


@pytest.mark.parametrize("days", [-1, 400])
def test_a_certificate_out_of_date_by_the_clock_of_the_control_says_so(live: Any, days: int) -> None:
    live.control.clock_off = timedelta(days=days)
    with pytest.raises(ComputationError, match="out of date by the control's clock"):
        run(live.connect())


def test_another_control_than_the_one_whose_certificate_was_stored_is_not_talked_to(live: Any) -> None:
    wrong = str(live.folder / "client.der")
    with pytest.raises(ComputationError, match="certificate is another one than"):
        run(live.connect(server_certificate=wrong, seconds=2.0))
    with pytest.raises(InputError, match="gearmath control trust"):
        run(live.connect(server_certificate=str(live.folder / "none.der")))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"security": "Basic256"}, "security Basic256 is not offered, but Basic256Sha256"),
        ({"security": "none"}, "this security is not offered"),
        ({"certificate": "trusted"}, "is no certificate in PEM or DER"),
        ({"key": "control.der"}, "is no private key without a password"),
        ({"key": "control_key.pem"}, "does not belong to"),
    ],
)
def test_certificates_and_policies_that_cannot_work_are_told_from_a_control_that_is_off(
    live: Any, tmp_path: Any, changes: dict[str, str], said: str
) -> None:
    (live.folder / "rubbish.der").write_bytes(b"rubbish")
    named = {
        key: str(live.folder / value.replace("trusted", "rubbish.der"))
        if "/" not in value and key != "security"
        else value
        for key, value in changes.items()
    }
    with pytest.raises((ComputationError, InputError), match=said) as error:
        run(live.connect(seconds=2.0, **named))
    assert "\n" not in str(error.value)


def test_a_full_session_table_is_said_and_is_no_wrong_password(live: Any) -> None:
    live.control.fill_sessions()
    with pytest.raises(NoSession, match="no session left"):
        run(live.connect())


def test_the_limits_of_the_control_hold_for_everybody(live: Any) -> None:
    """Ten sessions, ten subscriptions, a thousand samples a second, and the control's own intervals."""

    class Nothing:
        def datachange_notification(self, *_: Any) -> None: ...

    async def work() -> tuple[int, int, str, float]:
        ours = await live.connect()
        client: Client = ours._client
        subscriptions = []
        for _ in range(10):
            subscriptions.append(await client.create_subscription(130, Nothing()))
        with pytest.raises(ua.UaStatusCodeError) as many:
            await client.create_subscription(100, Nothing())
        nodes = [client.get_node(f"ns=2;s=/Channel/Parameter/R[u1,{k}]") for k in range(101)]
        interval: Any = 100.0
        with pytest.raises(ua.UaStatusCodeError) as samples:
            await subscriptions[0].subscribe_data_change(nodes, sampling_interval=interval)
        granted = subscriptions[0].parameters.RequestedPublishingInterval
        others = [await live.connect() for _ in range(9)]
        with pytest.raises(NoSession) as full:
            await live.connect()
        for one in (ours, *others):
            await one.close()
        return many.value.code, samples.value.code, str(full.value), granted

    many, samples, full, granted = run(work())
    assert granted == 250.0
    assert many == ua.StatusCodes.BadTooManySubscriptions
    assert samples == ua.StatusCodes.BadTooManyMonitoredItems
    assert "no session left" in full


def test_positions_come_ten_times_a_second_while_the_axes_move(live: Any) -> None:
    """Five positions at 10 Hz, in order, a new place almost every time; the machine takes the real time of a block.

    The median of the gaps, since a computer that does other things too may keep one of them waiting.
    """
    head = live.TEN.split("FOR UP")[0]
    text = f"{head}MEAS=1 G1 X50 Y=IC(0) Z=IC(0) A=IC(0) B=IC(0) F500\nM30\n"
    live.load(text)
    live.nc.speed = 1.0

    async def work() -> list[tuple[float, tuple[float, ...]]]:
        control = await live.connect(sinumerik.READ_STATE)
        found: list[tuple[float, tuple[float, ...]]] = []
        live.nc.start()
        async for one in control.watch(0.1):
            found.append(one)
            if len({position[0] for _, position in found}) == 20:
                break
        await control.close()
        return found

    found = run(work())
    gaps = [b[0] - a[0] for a, b in itertools.pairwise(found)]
    assert 0.08 <= statistics.median(gaps) <= 0.15
    assert len(found) <= 40  # of the 54 that 45 mm take
    along = [position[0] for _, position in found]
    assert along == sorted(along)


def test_r_parameters_are_watched_as_they_change_and_never_above_what_the_control_samples(live: Any) -> None:
    async def work() -> list[tuple[float, ...]]:
        control = await live.connect(sinumerik.READ_STATE, sinumerik.WRITE_STATE)
        await control.write_parameters({10: 1.5, 20: 2.0})
        found: list[tuple[float, ...]] = []
        async for _, values in control.watch_parameters([10, 20], 0.1):
            found.append(values)
            if values == (1.5, 7.0) or len(found) == 100:
                break
            if len(found) == 1:
                await control.write_parameters({20: 7.0})
        with pytest.raises(InputError, match=r"R1000: R parameters go from 0 to 999"):
            await anext(control.watch_parameters([1000], 1.0))
        with pytest.raises(InputError, match=r"200 R parameters every 0.1 s: the control samples 1000 values a second"):
            await anext(control.watch_parameters(range(200), 0.1))
        await control.close()
        return found

    found = run(work())
    assert (found[0], found[-1]) == ((1.5, 2.0), (1.5, 7.0))


def test_a_connection_that_breaks_is_a_lost_connection_and_no_traceback(live: Any) -> None:
    async def work() -> None:
        for trouble in (live.control.line.cut, live.control.line.die):
            control = await live.connect(seconds=2.0)
            live.soon(trouble)
            await asyncio.sleep(0.1)
            with pytest.raises(ConnectionLost):
                await control.status()
            await control.close()

    run(work())


def test_where_nobody_listens_is_said_at_once(live: Any) -> None:
    with pytest.raises(ConnectionLost, match=r"opc\.tcp://127\.0\.0\.1:9"):
        run(live.connect(url="opc.tcp://127.0.0.1:9"))
