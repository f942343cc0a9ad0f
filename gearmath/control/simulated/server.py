"""The simulated control as others see it: its OPC UA server, and the faults that it has on request."""

from __future__ import annotations

import asyncio
import logging
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from asyncua import Server, ua
from asyncua.crypto.truststore import TrustStore
from asyncua.crypto.validator import CertificateValidator, CertificateValidatorOptions
from asyncua.server.event_generator import EventGenerator

from gearmath.control import sinumerik
from gearmath.control.simulated.access import Access, caller
from gearmath.control.simulated.files import FileMethods
from gearmath.control.simulated.line import FaultyLine
from gearmath.control.simulated.nc import Nc, NcAlarm
from gearmath.control.simulated.session import ControlServer
from gearmath.control.simulated.values import first_names, item
from gearmath.control.ua_words import node_id, status

_HOST = "127.0.0.1"
URI = "urn:gearmath:simulated-control"
#: Values that subscriptions look at are compared so often. [s]
_TICK = 0.05


@dataclass(frozen=True)
class Identity:
    """Certificate and key of the control, and the folder of the client certificates that it trusts."""

    certificate: Path
    key: Path
    trusted: Path


@dataclass(frozen=True)
class Appearance:
    """What differs from server to server: where the copy methods are, and which policies there are besides."""

    homes: tuple[str, ...] = ("old", "new")
    unencrypted: bool = False


class SimulatedControl:
    """The control at ``url``. Use as an asynchronous context manager."""

    def __init__(
        self, nc: Nc, access: Access, identity: Identity | None, appearance: Appearance | None = None, port: int = 0
    ) -> None:
        self.nc, self.access, self.identity = nc, access, identity
        self.appearance = appearance or Appearance()
        self.line = FaultyLine(_HOST, port, 0)
        self.clock_off = timedelta()
        """What the clock of the control shows beyond the right time."""
        self._server: Server | None = None
        self._inner: ControlServer | None = None
        self._files: FileMethods | None = None
        self._ticker: asyncio.Task[None] | None = None
        self._generators: dict[str, EventGenerator] = {}
        self._loop: asyncio.AbstractEventLoop | None = None

    @property
    def url(self) -> str:
        """Where a client finds it."""
        return f"opc.tcp://{_HOST}:{self.line.port}"

    @property
    def inner(self) -> ControlServer:
        """Limits, samples and sessions."""
        assert self._inner is not None
        return self._inner

    async def __aenter__(self) -> SimulatedControl:
        self._loop = asyncio.get_running_loop()
        self.nc.on_alarm = self._tell
        await self._begin()
        await self.line.start()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.line.stop()
        await self._end()
        if self.nc.channel:
            await asyncio.to_thread(self.nc.reset)

    async def restart(self, seconds: float = 0.2) -> None:
        """The OPC UA server is down for so long; sessions and subscriptions are lost, the NC goes on."""
        self.line.refuse()
        for session in list(self.inner._external_sessions.values()):
            await session.close_session()
        await asyncio.sleep(seconds)
        await self.line.start()

    def fill_sessions(self, count: int = sinumerik.SESSIONS) -> None:
        """So many sessions are kept by others."""
        self.inner.strangers = count

    def answer_slowly(self, seconds: float) -> None:
        """Every answer takes so long."""
        self.inner.slowness = seconds

    def set_clock(self, off: timedelta) -> None:
        """The clock of the control is off by so much."""
        self.clock_off = self.inner.variables.clock_off = off

    async def _begin(self) -> None:
        caller.set(caller.get())
        self._inner = ControlServer(self.nc, self.access)
        server = self._server = Server(self._inner)
        server.disable_clock()
        await server.init()
        await server.set_application_uri(URI)
        server.name = "Simulated SINUMERIK 840D sl"
        server.set_endpoint(f"opc.tcp://{_HOST}:0")
        await self._secure(server)
        index = await server.register_namespace(sinumerik.NAMESPACE.text)
        root = await server.nodes.objects.add_object(
            node_id(sinumerik.ROOT.text, index), ua.QualifiedName(sinumerik.ROOT.text, index)
        )
        await self._areas(server, root, index)
        methods = await root.add_object(
            node_id(f"/{sinumerik.METHODS.text}", index), ua.QualifiedName(sinumerik.METHODS.text, index)
        )
        await methods.add_method(
            node_id(f"/{sinumerik.METHODS.text}/{sinumerik.MY_RIGHTS.text}", index),
            ua.QualifiedName(sinumerik.MY_RIGHTS.text, index),
            self._my_rights,
            [],
            [ua.VariantType.String],
        )
        self._files = FileMethods(server, self.nc, self.access, index)
        await self._files.build(root, methods, self.appearance.homes)
        await self._alarms(server, root)
        await server.start()
        assert server.bserver is not None
        self.line._server_port = server.bserver.port
        self._ticker = asyncio.create_task(self._tick())

    async def _end(self) -> None:
        if self._ticker is not None:
            self._ticker.cancel()
            with suppress(asyncio.CancelledError):
                await self._ticker
        if self._server is not None:
            for session in list(self.inner._external_sessions.values()):
                await session.close_session()
            await self._server.stop()
        self._generators.clear()

    async def _secure(self, server: Server) -> None:
        """Certificates, policies, users."""
        policies = []
        tokens: list[type] = [ua.UserNameIdentityToken]
        if self.identity is not None:
            await server.load_certificate(self.identity.certificate)
            await server.load_private_key(self.identity.key)
            policies.append(ua.SecurityPolicyType.Basic256Sha256_SignAndEncrypt)
            tokens.append(ua.X509IdentityToken)
            store = TrustStore([self.identity.trusted], [])
            await store.load()
            validator = CertificateValidator(
                CertificateValidatorOptions.TRUSTED_VALIDATION | CertificateValidatorOptions.PEER_CLIENT, store
            )
            server.set_certificate_validator(self._at_its_own_time(validator))
        if self.appearance.unencrypted or self.identity is None:
            policies.append(ua.SecurityPolicyType.NoSecurity)
        if self.access.anonymous:
            tokens.append(ua.AnonymousIdentityToken)
        server.set_security_policy(policies)
        server.set_identity_tokens(tokens)

    def _at_its_own_time(self, validator: CertificateValidator) -> Any:
        """A validator that looks at the dates of a certificate by the clock of the control."""

        async def validate(certificate: Any, description: ua.ApplicationDescription) -> None:
            await validator(certificate, description)
            now = datetime.now(UTC) + self.clock_off
            if not certificate.not_valid_before_utc <= now <= certificate.not_valid_after_utc:
                raise ua.uaerrors.BadCertificateTimeInvalid

        return validate

    async def _areas(self, server: Server, root: Any, index: int) -> None:
        """What browsing shows of the variables: the first of each kind."""
        areas: dict[str, Any] = {}
        for name in first_names():
            place, path = root, ""
            *folders, last = name.split("/")[1:]
            for folder in folders:
                path += f"/{folder}"
                if path not in areas:
                    areas[path] = await place.add_object(
                        node_id(path, index), ua.QualifiedName(folder, index), ua.ObjectIds.FolderType
                    )
                place = areas[path]
            node = node_id(name, index)
            if (found := item(name)) is None:
                continue
            shown = await place.add_variable(node, ua.QualifiedName(last, index), found.read(self.nc))
            if found.write is not None:
                await shown.set_writable()
            self.inner.variables.find(node)

    async def _alarms(self, server: Server, root: Any) -> None:
        """Alarms come from ``Sinumerik``, and so do the brackets of a refresh."""
        index = await server.register_namespace(sinumerik.ALARM_NAMESPACE.text)
        self._alarm_type = await server.create_custom_event_type(
            index,
            sinumerik.ALARM_TYPE.text,
            node_id(ua.ObjectIds.DiscreteAlarmType),
            [
                ("AlarmIdentifier", ua.VariantType.String),
                ("AuxParameters", ua.VariantType.String),
                ("HelpSource", ua.VariantType.String),
            ],
        )
        self._root = root
        for kind in (ua.ObjectIds.RefreshStartEventType, ua.ObjectIds.RefreshEndEventType):
            generator = EventGenerator(self.inner.isession)
            await generator.init(node_id(kind), emitting_node=root, add_generates_event=False)
            self.inner.subscription_service.standard_events[kind] = generator
        for key, alarm in list(self.nc.alarms.items()):
            await self._emit(key, alarm, True)

    def _tell(self, key: str, alarm: NcAlarm, active: bool) -> None:
        """From the thread of the NC, or from this one."""
        assert self._loop is not None
        asyncio.run_coroutine_threadsafe(self._emit(key, alarm, active), self._loop)

    async def _emit(self, key: str, alarm: NcAlarm, active: bool) -> None:
        if self._server is None:
            return
        if key not in self._generators:
            generator = EventGenerator(self.inner.isession)
            await generator.init(self._alarm_type, emitting_node=self._root)
            self._generators[key] = generator
        event = self._generators[key].event
        event.NodeId = node_id(f"alarm-{key}", self.inner.variables.index)
        event.ConditionName, event.BranchId = alarm.number, ua.NodeId()
        event.AlarmIdentifier, event.HelpSource, event.AuxParameters = alarm.number, "", ""
        event.SourceName = "NCK"
        event.Severity, event.Retain = alarm.severity, active
        event.ActiveState = ua.LocalizedText("Active" if active else "Inactive")
        setattr(event, "ActiveState/Id", active)
        await self._generators[key].trigger(time_attr=datetime.now(UTC) + self.clock_off, message=alarm.text)

    async def _my_rights(self, _: ua.NodeId) -> Any:
        """GetMyAccessRights: the rights joined by semicolons (the form is unconfirmed)."""
        try:
            self.access.method_allowed()
        except ua.UaStatusCodeError as refused:
            return ua.CallMethodResult(StatusCode=status(refused.code))
        return [ua.Variant(";".join(sorted(self.access.rights(caller.get()))), ua.VariantType.String)]

    async def _tick(self) -> None:
        """What changes by itself: values that are looked at, and files that programs wrote."""
        shown: dict[ua.NodeId, Any] = {}
        while True:
            await asyncio.sleep(_TICK)
            try:
                await self.inner.current_time_node.write_value(datetime.now(UTC) + self.clock_off)
                await self.inner.variables.publish(shown)
                assert self._files is not None
                await self._files.refresh()
            except Exception:
                logging.getLogger(__name__).exception("simulated control")
