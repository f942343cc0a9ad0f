"""A SINUMERIK over OPC UA: R parameters, positions, alarms, files, handshake."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncGenerator, Mapping, Sequence
from typing import Any

from asyncua import Client, ua
from asyncua.common.node import Node
from asyncua.common.subscription import Subscription

from gearmath.control import sinumerik
from gearmath.control.alarms import Alarms
from gearmath.control.interface import Alarm, ChannelState, ConnectionLost, Handshake, Status, Touch
from gearmath.control.login import log_in
from gearmath.control.r_parameters import check_numbers, check_values, groups_of, parts_of
from gearmath.control.refusals import asked, code_name
from gearmath.control.transfer import Transfer
from gearmath.control.ua_words import node_id
from gearmath.errors import ComputationError, InputError
from gearmath.machine.control.file_names import control_name, shown
from gearmath.specs.control_connection import ControlConnection

#: R parameters of the handshake: point offered, run, point acknowledged, whether a host is waited for; the touch.
_OFFERED, _RUN, _ACKNOWLEDGED, _WAITS, _TOUCH = 101, 102, 103, 104, 200
#: First and last part of a program that its next run makes.
_FIRST, _LAST = 90, 91
#: How long any answer may take. [s]
PATIENCE = 4.0


class OpcUaControl:
    """One session on a control. It is not used again after a ConnectionLost: connect anew."""

    def __init__(self, connection: ControlConnection, client: Client, index: int, rights: frozenset[str]) -> None:
        self.name, self.rights = connection.name, rights
        self._connection, self._client, self._index = connection, client, index
        self._read_limit = self._write_limit = 0
        self._alarms: Alarms | None = None
        self._transfer = Transfer(self.name, client, index)
        self._subscriptions: list[Subscription] = []

    @staticmethod
    async def connect(
        connection: ControlConnection, password: str = "", needed: Sequence[str] = (), seconds: float = PATIENCE
    ) -> OpcUaControl:
        """A new session, with the rights that are ``needed``.

        Raises ConnectionLost where there is no answer, NoSession where the session table is full, and ComputationError
        in one sentence where the control refuses or the user lacks a right.
        """
        client = await log_in(connection, password, seconds)
        try:
            with asked(connection.name, "looking up the control's names"):
                names = await client.get_namespace_array()
                if sinumerik.NAMESPACE.text not in names:
                    raise ComputationError(
                        f"{connection.name}: {connection.url} is no SINUMERIK: "
                        f"it has no namespace {sinumerik.NAMESPACE.text}"
                    )
                index = names.index(sinumerik.NAMESPACE.text)
            control = OpcUaControl(connection, client, index, frozenset())
            control.rights = await control._my_rights()
            for right in needed:
                control.need(right)
            await control._limits()
        except BaseException:
            await _end(client)
            raise
        return control

    async def close(self) -> None:
        """Give the session back, if the control still listens."""
        await _end(self._client)

    def need(self, right: str) -> None:
        """Raises ComputationError naming a right that the user lacks."""
        every = sinumerik.WRITE_ALL if right.endswith("Write") else sinumerik.READ_ALL
        if not {right.upper(), every.upper()} & {one.upper() for one in self.rights}:
            held = ", ".join(sorted(self.rights)) or "none"
            raise ComputationError(
                f"{self.name}: user {self._connection.user or 'of the certificate'!r} lacks the right {right}, which "
                f"the control's administrator gives; it has {held}"
            )

    # data

    async def status(self) -> Status:
        """Channel, mode, selected program, message and position."""
        channel = self._connection.channel
        names = [
            sinumerik.CHANNEL_STATE(channel=channel),
            sinumerik.MODE(),
            sinumerik.SELECTED(channel=channel),
            sinumerik.MESSAGE(channel=channel),
            *self._position_names(),
        ]
        state, mode, selected, message, *position = await self._read(names)
        return Status(
            sinumerik.CHANNEL_STATES.get(state, ChannelState.UNKNOWN),
            sinumerik.MODES.get(mode, "unknown"),
            sinumerik.program_name(str(selected or "")),
            _plain(message),
            tuple(map(self._real, position)),
        )

    async def read_parameters(self, numbers: Sequence[int]) -> list[float]:
        """R parameters, those that follow each other as one array."""
        check_numbers(numbers)
        groups = groups_of(numbers)
        values = await self._read([self._parameters(first, count) for first, count in groups])
        found: dict[int, float] = {}
        for (first, count), value in zip(groups, values, strict=True):
            for k, one in enumerate(value if isinstance(value, list) else [value]):
                found[first + k] = self._real(one)
            if len(found) == 0 or first + count - 1 not in found:
                raise ComputationError(f"{self.name}: R{first}: {count} values were asked for, others came")
        return [found[number] for number in numbers]

    async def write_parameters(self, values: Mapping[int, float]) -> None:
        """Set R parameters other than those of the handshake."""
        check_values(values)
        await self._write(values)

    def watch(self, interval: float) -> AsyncGenerator[tuple[float, tuple[float, ...]], None]:
        """Time [s] and position at every ``interval`` [s], by a subscription at the control's next interval.

        Whoever stops early must close it: a subscription that is left stays on the control.
        """
        return self._subscribed(self._position_names(), interval, "positions")

    def watch_parameters(
        self, numbers: Sequence[int], interval: float
    ) -> AsyncGenerator[tuple[float, tuple[float, ...]], None]:
        """Time [s] and R parameters, in the same way.

        Raises InputError for numbers that there are not, and for more than the control samples in a second.
        """
        check_numbers(numbers)
        many = len(numbers) * 1000 / _next_interval(interval)
        if many > sinumerik.SAMPLES_PER_SECOND:
            raise InputError(
                f"{len(numbers)} R parameters every {interval:g} s: the control samples {sinumerik.SAMPLES_PER_SECOND} "
                "values a second at most"
            )
        names = [self._parameters(number, 1) for number in numbers]
        return self._subscribed(names, interval, "R parameters")

    async def _subscribed(
        self, names: Sequence[str], interval: float, what: str
    ) -> AsyncGenerator[tuple[float, tuple[float, ...]], None]:
        latest: dict[str, float] = {}

        class Handler:
            def datachange_notification(self, node: Node, value: Any, data: Any) -> None:
                latest[str(node.nodeid.Identifier)] = value

            def status_change_notification(self, status: Any) -> None:
                latest["lost"] = 1.0

        milliseconds = _next_interval(interval)
        rate: Any = float(milliseconds)
        with asked(self.name, f"subscribing to {what}", sinumerik.READ_STATE):
            subscription = await self._client.create_subscription(milliseconds, Handler())
            self._subscriptions.append(subscription)
            await subscription.subscribe_data_change([self._node(name) for name in names], sampling_interval=rate)
        try:
            due = time.monotonic()
            while True:
                due += interval
                await asyncio.sleep(max(0.0, due - time.monotonic()))
                if "lost" in latest or self._client.uaclient.state.name not in ("CONNECTED", "READY", "ACTIVE"):
                    raise ConnectionLost(f"{self.name}: the connection is lost ({what})")
                if all(name in latest for name in names):
                    yield time.monotonic(), tuple(latest[name] for name in names)
        finally:
            with _quietly():
                await subscription.delete()

    async def probe_deflected(self) -> bool | None:
        """The signal of probe 1, as the PLC gets it; None where the control has it not, or the user may not read it."""
        try:
            (value,) = await self._read([sinumerik.PROBE()])
        except ConnectionLost:
            raise
        except ComputationError:
            return None
        return bool(value) if isinstance(value, bool | int) else None

    # alarms and files

    async def alarms(self) -> list[Alarm]:
        """The alarms that are active, each once."""
        if self._alarms is None:
            self._alarms = await Alarms.subscribed(self.name, self._client, self._index)
        return self._alarms.active()

    async def put(self, name: str, content: bytes, replace: bool = False) -> None:
        """Write a program; not the selected one, and none while the channel is active."""
        name = control_name(name)
        status = await self.status()
        if status.channel is not ChannelState.RESET:
            raise ComputationError(
                f"{self.name}: {name} is not written: the channel is {status.channel}, must be reset"
            )
        if status.selected == name:
            raise ComputationError(
                f"{self.name}: {name} is not written: it is the selected program, select another first"
            )
        await self._transfer.put(name, content, replace)

    async def get(self, name: str) -> bytes:
        """A file of the control."""
        return await self._transfer.get(name)

    # the handshake

    async def handshake(self) -> Handshake:
        """Point offered, run, point acknowledged, whether the program waits, read as one value."""
        offered, run, acknowledged, waits = await self.read_parameters(range(_OFFERED, _WAITS + 1))
        return Handshake(round(offered), round(run), round(acknowledged), waits == 1.0)

    async def touch(self, number: int) -> Touch:
        """R200 to R205."""
        return Touch(number, *await self.read_parameters(range(_TOUCH, _TOUCH + 6)))

    async def acknowledge(self, point: int) -> None:
        """R103 = point: the program goes on."""
        await self._write({_ACKNOWLEDGED: float(point)})

    async def prepare(self, first: int, last: int) -> None:
        """R90, R91 and R104, with the channel in reset."""
        if (await self.status()).channel is not ChannelState.RESET:
            raise ComputationError(f"{self.name}: the run cannot be prepared: the channel is not in reset")
        await self._write({_FIRST: float(first), _LAST: float(last), _WAITS: 1.0})

    async def finished(self) -> None:
        """R104 = 0."""
        await self._write({_WAITS: 0.0})

    # nodes

    def _node(self, name: str) -> Node:
        return self._client.get_node(node_id(name, self._index))

    def _position_names(self) -> list[str]:
        return [sinumerik.POSITION(axis=axis) for axis in self._connection.axes]

    def _parameters(self, first: int, count: int) -> str:
        channel = self._connection.channel
        if count == 1:
            return sinumerik.PARAMETER(channel=channel, first=first)
        return sinumerik.PARAMETERS(channel=channel, first=first, count=count)

    async def _read(self, names: Sequence[str]) -> list[Any]:
        """Values by name, in batches that the control takes."""
        values: list[Any] = []
        for part in parts_of(names, self._read_limit):
            with asked(self.name, f"reading {part[0]}", sinumerik.READ_STATE):
                found = await self._client.uaclient.session.read_attributes(
                    [node_id(name, self._index) for name in part], ua.AttributeIds.Value
                )
            for name, one in zip(part, found, strict=True):
                self._check(name, one.StatusCode, sinumerik.READ_STATE)
                values.append(one.Value.Value if one.Value is not None else None)
        return values

    async def _write(self, values: Mapping[int, float]) -> None:
        for part in parts_of(list(values.items()), self._write_limit):
            names = [self._parameters(number, 1) for number, _ in part]
            with asked(self.name, f"writing R{part[0][0]}", sinumerik.WRITE_STATE):
                codes = await self._client.uaclient.session.write_attributes(
                    [node_id(name, self._index) for name in names],
                    [ua.DataValue(ua.Variant(float(value), ua.VariantType.Double)) for _, value in part],
                    ua.AttributeIds.Value,
                )
            for name, code in zip(names, codes, strict=True):
                self._check(name, code, sinumerik.WRITE_STATE)

    def _check(self, name: str, code: ua.StatusCode | None, right: str) -> None:
        if code is None or _good(code):
            return
        if code.value == ua.StatusCodes.BadUserAccessDenied:
            raise ComputationError(f"{self.name}: {name} is refused: the user lacks the right {right}")
        if code.value in (
            ua.StatusCodes.BadAttributeIdInvalid,
            ua.StatusCodes.BadNodeIdInvalid,
            ua.StatusCodes.BadNodeIdUnknown,
        ):
            raise ComputationError(f"{self.name}: the control has no variable {name}")
        raise ComputationError(f"{self.name}: {name}: {code_name(code.value)}")

    def _real(self, value: Any) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ComputationError(f"{self.name}: the control gives {shown(str(value))} where a number must be")
        return float(value)

    async def _my_rights(self) -> frozenset[str]:
        """GetMyAccessRights, as one text or as a list."""
        with asked(self.name, "asking for the rights of the user"):
            methods = await self._transfer.area(sinumerik.METHODS)
            method = await self._transfer.child(methods, sinumerik.MY_RIGHTS)
            if methods is None or method is None:
                raise ComputationError(f"{self.name}: the control has no method {sinumerik.MY_RIGHTS.text}")
            answer = await methods.call_method(method.nodeid)
        texts = answer if isinstance(answer, list) else [answer]
        return frozenset(part.strip() for text in texts for part in str(text or "").split(";") if part.strip())

    async def _limits(self) -> None:
        """How many values a request may have; 0 where the control does not say it."""
        limits = ua.ObjectIds
        with asked(self.name, "reading the limits of the server"):
            found = await self._client.uaclient.session.read_attributes(
                [
                    node_id(limits.Server_ServerCapabilities_OperationLimits_MaxNodesPerRead),
                    node_id(limits.Server_ServerCapabilities_OperationLimits_MaxNodesPerWrite),
                ],
                ua.AttributeIds.Value,
            )
        self._read_limit, self._write_limit = (
            int(one.Value.Value or 0) if one.Value is not None and _good(one.StatusCode) else 0 for one in found
        )


def _good(code: ua.StatusCode | None) -> bool:
    return code is None or code.is_good()


def _plain(text: Any) -> str:
    """A text of the control without control characters, in one line."""
    return "".join(letter if letter.isprintable() else " " for letter in str(text or ""))[:200].strip()


class _quietly:
    """Leaves out what goes wrong while something is given up that may be gone already."""

    def __enter__(self) -> None: ...

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> bool:
        return kind is not None and issubclass(kind, Exception)


async def _end(client: Client) -> None:
    with _quietly():
        await asyncio.wait_for(client.disconnect(), 1.0)
    with _quietly():
        client.disconnect_socket()


def _next_interval(seconds: float) -> int:
    """The next of the control's own intervals that is not shorter [ms]."""
    own = sinumerik.INTERVALS_MS
    return next((one for one in own if one >= 1000 * seconds - 1e-6), own[-1])
