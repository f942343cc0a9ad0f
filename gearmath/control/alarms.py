"""Alarms over OPC UA: those that are active when one looks, and those that come and go, each once."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import Any

from asyncua import Client, ua

from gearmath.control import sinumerik
from gearmath.control.interface import Alarm
from gearmath.control.refusals import asked
from gearmath.control.ua_words import node_id

_REFRESHED = node_id(ua.ObjectIds.RefreshEndEventType)
_BRACKETS = (node_id(ua.ObjectIds.RefreshStartEventType), _REFRESHED)
#: How long the end of a refresh is waited for: not every server sends it to every listener. [s]
_REFRESH = 1.0
#: More alarms than this are not kept: a control that repeats itself must not fill the memory.
_MOST = 1000


class Alarms:
    """What events of one subscription have said."""

    def __init__(self) -> None:
        self._alarms: dict[str, Alarm] = {}
        self._refreshed = asyncio.Event()

    @staticmethod
    async def subscribed(name: str, client: Client, index: int) -> Alarms:
        """Listen to the object ``Sinumerik``, and to Server where there is no such object; ask for what is active."""
        found = Alarms()
        with asked(name, "subscribing to alarms", sinumerik.READ_ALARMS):
            source = client.get_node(node_id(sinumerik.ROOT.text, index))
            try:
                await source.read_browse_name()
            except ua.UaStatusCodeError:
                source = client.nodes.server
            subscription = await client.create_subscription(100, found)
            await subscription.subscribe_events(source, evfilter=_filter())
            with suppress(ua.UaStatusCodeError):  # a server that cannot refresh tells of later changes only
                await client.get_node(ua.ObjectIds.ConditionType).call_method(
                    node_id(ua.ObjectIds.ConditionType_ConditionRefresh),
                    ua.Variant(subscription.subscription_id, ua.VariantType.UInt32),
                )
                with suppress(asyncio.TimeoutError):
                    await asyncio.wait_for(found._refreshed.wait(), _REFRESH)
        return found

    def active(self) -> list[Alarm]:
        """Each alarm once, in the order in which they came."""
        return [alarm for alarm in self._alarms.values() if alarm.active]

    def event_notification(self, event: Any) -> None:
        """One event; the brackets of a refresh are no alarms."""
        kind = getattr(event, "EventType", None)
        if kind in _BRACKETS:
            if kind == _REFRESHED:
                self._refreshed.set()
            return
        retain = getattr(event, "Retain", None)
        if retain is None:
            return  # no condition
        message = getattr(event, "Message", None)
        text = (message.Text if isinstance(message, ua.LocalizedText) else str(message or "")) or ""
        number = str(getattr(event, "AlarmIdentifier", None) or getattr(event, "ConditionName", None) or "")
        condition = getattr(event, "NodeId", None)
        key = condition.to_string() if isinstance(condition, ua.NodeId) else number
        at = getattr(event, "Time", None)
        plain = "".join(letter if letter.isprintable() else " " for letter in text)[:300]
        alarm = Alarm(
            key,
            number[:40],
            plain,
            int(getattr(event, "Severity", 0) or 0),
            bool(retain),
            at.isoformat(timespec="seconds") if at is not None else "",
        )
        if not alarm.active:
            self._alarms.pop(key, None)
        elif key in self._alarms or len(self._alarms) < _MOST:
            self._alarms[key] = alarm


def _filter() -> ua.EventFilter:
    """The fields that are wanted, of all events."""
    chosen = ua.EventFilter()
    fields = (
        (ua.ObjectIds.BaseEventType, ("EventType", "SourceName", "Time", "Message", "Severity")),
        (ua.ObjectIds.ConditionType, ("ConditionName", "Retain")),
        (ua.ObjectIds.BaseEventType, ("AlarmIdentifier",)),
    )
    for kind, names in fields:
        for name in names:
            operand = ua.SimpleAttributeOperand(
                TypeDefinitionId=node_id(kind),
                BrowsePath=[ua.QualifiedName(name, 0)],
                AttributeId=ua.AttributeIds.Value,
            )
            chosen.SelectClauses.append(operand)
    chosen.SelectClauses.append(
        ua.SimpleAttributeOperand(
            TypeDefinitionId=node_id(ua.ObjectIds.ConditionType), BrowsePath=[], AttributeId=ua.AttributeIds.NodeId
        )
    )
    return chosen
