"""Sessions of the simulated control: rights, limits and samples are looked at before asyncua does what is asked."""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import Callable, Iterable
from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING, Any

from asyncua import ua
from asyncua.common.utils import ServiceError
from asyncua.crypto.permission_rules import User
from asyncua.server.address_space import AttributeValue, NodeData
from asyncua.server.internal_server import InternalServer
from asyncua.server.internal_session import InternalSession

from gearmath.control import sinumerik
from gearmath.control.simulated.access import NOBODY, Access, caller
from gearmath.control.simulated.nc import Nc
from gearmath.control.simulated.values import Item, item
from gearmath.control.ua_words import node_id, status

if TYPE_CHECKING:
    from asyncua.server.address_space import AddressSpace

_VALUE = ua.AttributeIds.Value
_CODES = ua.StatusCodes


class Variables:
    """Variables of the control as nodes; each comes to be when it is first asked for, and cannot be browsed to."""

    def __init__(self, nc: Nc, space: AddressSpace, index: int) -> None:
        self.nc, self.space, self.index = nc, space, index
        self.items: dict[ua.NodeId, Item] = {}
        self.clock_off = timedelta()

    def find(self, nodeid: ua.NodeId) -> Item | None:
        """The variable behind a node, its node made if need be."""
        if nodeid in self.items:
            return self.items[nodeid]
        if nodeid.NamespaceIndex != self.index or not isinstance(nodeid.Identifier, str):
            return None
        found = item(nodeid.Identifier)
        if found is None:
            return None
        self.items[nodeid] = found
        if nodeid not in self.space:
            self.space[nodeid] = self._node(nodeid, found)
        self.space[nodeid].attributes[_VALUE].value_callback = self.value
        return found

    def value(self, nodeid: ua.NodeId, attribute: ua.AttributeIds) -> ua.DataValue:
        """The value now, by the clock of the control."""
        value = self.items[nodeid].read(self.nc)
        at: Any = datetime.now(UTC) + self.clock_off
        return ua.DataValue(ua.Variant(value, _kind(value)), SourceTimestamp=at)

    def monitored(self) -> Iterable[ua.NodeId]:
        """The variables that some subscription looks at."""
        return [one for one in self.items if self.space[one].attributes[_VALUE].datachange_callbacks]

    async def publish(self, before: dict[ua.NodeId, Any]) -> None:
        """Tell subscriptions what has changed since ``before``, which is brought up to date."""
        for nodeid in self.monitored():
            value = self.value(nodeid, _VALUE)
            now = value.Value.Value if value.Value is not None else None
            if nodeid in before and before[nodeid] == now:
                continue
            before[nodeid] = now
            for handle, call in list(self.space[nodeid].attributes[_VALUE].datachange_callbacks.items()):
                await call(handle, value)

    def _node(self, nodeid: ua.NodeId, found: Item) -> NodeData:
        value = found.read(self.nc)
        access = 3 if found.write else 1
        name = str(nodeid.Identifier).rsplit("/", 1)[-1]
        byte, i32 = ua.VariantType.Byte, ua.VariantType.Int32
        attributes = {
            ua.AttributeIds.NodeId: ua.Variant(nodeid),
            ua.AttributeIds.NodeClass: ua.Variant(ua.NodeClass.Variable, i32),
            ua.AttributeIds.BrowseName: ua.Variant(ua.QualifiedName(name, self.index)),
            ua.AttributeIds.DisplayName: ua.Variant(ua.LocalizedText(name)),
            ua.AttributeIds.DataType: ua.Variant(node_id(_kind(value).value)),
            ua.AttributeIds.ValueRank: ua.Variant(1 if isinstance(value, list) else -1, i32),
            ua.AttributeIds.AccessLevel: ua.Variant(access, byte),
            ua.AttributeIds.UserAccessLevel: ua.Variant(access, byte),
            ua.AttributeIds.MinimumSamplingInterval: ua.Variant(float(sinumerik.INTERVALS_MS[0])),
            ua.AttributeIds.Historizing: ua.Variant(False),
            _VALUE: ua.Variant(value, _kind(value)),
        }
        node = NodeData(nodeid)
        node.attributes = {key: AttributeValue(ua.DataValue(variant)) for key, variant in attributes.items()}
        return node


def _kind(value: Any) -> ua.VariantType:
    if isinstance(value, str):
        return ua.VariantType.String
    return ua.VariantType.Int32 if isinstance(value, int) else ua.VariantType.Double


class Budget:
    """Samples of the last second: values read, and values that subscriptions look at."""

    def __init__(self) -> None:
        self._reads: deque[tuple[float, int]] = deque()
        self.subscribed: dict[tuple[int, int], float] = {}
        """Samples a second of every monitored item, by subscription and item."""
        self.most = 0.0

    def take(self, count: int) -> None:
        """Count values that are read now."""
        now = time.monotonic()
        self._reads.append((now, count))
        while self._reads and self._reads[0][0] < now - 1.0:
            self._reads.popleft()
        self.most = max(self.most, sum(count for _, count in self._reads) + sum(self.subscribed.values()))


class ControlSession(InternalSession):
    """A session that asks whether its user may, and whether the control could, before it does anything."""

    async def create_session(
        self, params: ua.CreateSessionParameters, sockname: tuple[str, int] | None = None
    ) -> ua.CreateSessionResult:
        others = [one for one in self.iserver._external_sessions.values() if one is not self]
        if self.external and len(others) + self.iserver.strangers >= sinumerik.SESSIONS:  # type: ignore[attr-defined]
            await self.close_session()
            raise ServiceError(_CODES.BadTooManySessions)
        return await super().create_session(params, sockname)

    @property
    def _control(self) -> ControlServer:
        assert isinstance(self.iserver, ControlServer)
        return self.iserver

    async def _before(self) -> None:
        """Whoever calls, and as slowly as was asked for."""
        caller.set(self.user)
        if self.external and self._control.slowness > 0.0:
            await asyncio.sleep(self._control.slowness)

    async def read(self, params: ua.ReadParameters) -> list[ua.DataValue]:
        if not self.external:
            return await super().read(params)
        await self._before()
        control = self._control
        ours = [control.variables.find(one.NodeId) for one in params.NodesToRead]
        control.budget.take(sum(found is not None for found in ours))
        results = await super().read(params)
        may = control.access.may(self.user, sinumerik.READ_STATE)
        for k, (one, found) in enumerate(zip(params.NodesToRead, ours, strict=True)):
            if found is not None and not may:
                results[k] = ua.DataValue(StatusCode=status(_CODES.BadUserAccessDenied))
            elif (
                found is None and one.NodeId.NamespaceIndex == control.variables.index and one.NodeId not in self.aspace
            ):
                results[k] = ua.DataValue(StatusCode=status(_CODES.BadAttributeIdInvalid))
        return results

    async def write(self, params: ua.WriteParameters) -> list[ua.StatusCode]:
        if not self.external:
            return await super().write(params)
        await self._before()
        return [self._written(one) for one in params.NodesToWrite]

    def _written(self, one: ua.WriteValue) -> ua.StatusCode:
        found = self._control.variables.find(one.NodeId)
        if found is None:
            return status(_CODES.BadAttributeIdInvalid)
        if not self._control.access.may(self.user, sinumerik.WRITE_STATE):
            return status(_CODES.BadUserAccessDenied)
        if one.AttributeId != _VALUE or found.write is None:
            return status(_CODES.BadNotWritable)
        value = one.Value.Value.Value if one.Value.Value is not None else None
        try:
            found.write(self._control.nc, value)
        except (TypeError, ValueError):
            return status(_CODES.BadTypeMismatch)
        return ua.StatusCode()

    async def call(self, params: list[ua.CallMethodRequest]) -> list[ua.CallMethodResult]:
        if self.external:
            await self._before()
        return await super().call(params)

    async def browse(self, params: ua.BrowseParameters) -> list[ua.BrowseResult]:
        if self.external:
            await self._before()
        return await super().browse(params)

    async def create_monitored_items(
        self, params: ua.CreateMonitoredItemsParameters
    ) -> list[ua.MonitoredItemCreateResult]:
        if not self.external:
            return await super().create_monitored_items(params)
        await self._before()
        control = self._control
        for one in params.ItemsToCreate:
            events = one.ItemToMonitor.AttributeId == ua.AttributeIds.EventNotifier
            if not control.access.may(self.user, sinumerik.READ_ALARMS if events else sinumerik.READ_STATE):
                raise ServiceError(_CODES.BadUserAccessDenied)
            if not events:
                control.variables.find(one.ItemToMonitor.NodeId)
        rates = [
            0.0
            if one.ItemToMonitor.AttributeId == ua.AttributeIds.EventNotifier
            else 1000.0 / granted(one.RequestedParameters.SamplingInterval)
            for one in params.ItemsToCreate
        ]
        if sum(control.budget.subscribed.values()) + sum(rates) > sinumerik.SAMPLES_PER_SECOND:
            raise ServiceError(_CODES.BadTooManyMonitoredItems)
        results = await super().create_monitored_items(params)
        for result, rate in zip(results, rates, strict=True):
            if result.StatusCode.is_good():
                control.budget.subscribed[int(params.SubscriptionId), int(result.MonitoredItemId)] = rate
        control.budget.take(0)
        return results

    async def create_subscription(
        self,
        params: ua.CreateSubscriptionParameters,
        callback: Callable[..., Any],
        request_callback: Callable[..., Any] | None = None,
    ) -> ua.CreateSubscriptionResult:
        if self.external:
            await self._before()
            params.RequestedPublishingInterval = granted(params.RequestedPublishingInterval)
        return await super().create_subscription(params, callback, request_callback)

    async def delete_subscriptions(self, ids: list[int]) -> list[ua.StatusCode]:
        for key in [one for one in self._control.budget.subscribed if one[0] in ids]:
            del self._control.budget.subscribed[key]
        return await super().delete_subscriptions(ids)


def granted(interval: float) -> float:
    """The interval [ms] that the control grants: the next longer one of its own, at least 100."""
    return float(next((one for one in sinumerik.INTERVALS_MS if interval <= one), sinumerik.INTERVALS_MS[-1]))


class ControlServer(InternalServer):
    """The inside of the server, with sessions of its own kind and the limits of an 840D sl."""

    def __init__(self, nc: Nc, access: Access) -> None:
        self.nc, self.access, self.budget = nc, access, Budget()
        self.slowness, self.strangers = 0.0, 0
        """Seconds before every answer; sessions that others keep."""
        super().__init__(user_manager=access)  # type: ignore[arg-type]
        self.max_session_timeout_ms = 1000.0 * sinumerik.SESSION_SECONDS
        self.max_subscriptions = sinumerik.SUBSCRIPTIONS
        self.bind_condition_methods = True
        self.variables = Variables(nc, self.aspace, 2)

    def create_session(self, name: str, user: User = NOBODY, external: bool = False) -> InternalSession:
        """A session of a client."""
        return ControlSession(self, self.aspace, self.subscription_service, name, user=user, external=external)
