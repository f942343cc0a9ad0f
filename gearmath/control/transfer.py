"""Files over OPC UA: the copy methods, browsed for by name in both of their homes; larger files by the file object."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from asyncua import Client, ua
from asyncua.common.node import Node

from gearmath.control import sinumerik
from gearmath.control.refusals import asked, refusal
from gearmath.control.sinumerik import Confirmed
from gearmath.control.ua_words import node_id
from gearmath.errors import ComputationError
from gearmath.machine.control.file_names import control_name

#: Bytes of one Read or Write of a file object.
_CHUNK = 1 << 18
_READ, _WRITE, _ERASE = 1, 2, 4
#: What a missing file, a missing right and the like are answered with: asking in another way changes nothing.
_FINAL = {
    ua.StatusCodes.BadNotFound,
    ua.StatusCodes.BadUserAccessDenied,
    ua.StatusCodes.BadNotSupported,
    ua.StatusCodes.BadEntryExists,
    ua.StatusCodes.BadNotWritable,
}


class Transfer:
    """Writes and reads programs and result files."""

    def __init__(self, name: str, client: Client, index: int) -> None:
        self._name, self._client, self._index = name, client, index

    async def put(self, name: str, content: bytes, replace: bool) -> None:
        """Write a file and read back how long it is. Raises ComputationError in one sentence where it is refused."""
        name = control_name(name)
        with asked(self._name, f"writing {name}", sinumerik.WRITE_FILES):
            if len(content) <= sinumerik.COPY_LIMIT:
                arguments = [
                    ua.Variant(_path(name), ua.VariantType.String),
                    ua.Variant(content, ua.VariantType.ByteString),
                    ua.Variant(replace, ua.VariantType.Boolean),
                ]
                await self._copy(sinumerik.COPY_TO, arguments)
            else:
                await self._put_large(name, content, replace)

    async def get(self, name: str) -> bytes:
        """The bytes of a file."""
        name = control_name(name)
        with asked(self._name, f"reading {name}", sinumerik.READ_FILES):
            try:
                content = await self._copy(sinumerik.COPY_FROM, [ua.Variant(_path(name), ua.VariantType.String)])
            except ua.UaStatusCodeError as error:
                node = None if error.code in _FINAL else await self._file(name)
                if node is None:
                    raise
                return await self._get_large(node)
        if not isinstance(content, bytes):
            raise ComputationError(f"{self._name}: reading {name}: the control gives no bytes")
        return content

    async def area(self, area: Confirmed) -> Node | None:
        """A folder right below ``Sinumerik``."""
        return await self.child(self._client.get_node(node_id(sinumerik.ROOT.text, self._index)), area)

    async def child(self, parent: Node | None, name: Confirmed | str) -> Node | None:
        """What is called so below a node, in whatever namespace."""
        wanted = (name if isinstance(name, str) else name.text).upper()
        if parent is None:
            return None
        for one in await parent.get_children_descriptions():
            if one.BrowseName.Name.upper() == wanted:
                return self._client.get_node(one.NodeId)
        return None

    async def _copy(self, method: Confirmed, arguments: list[ua.Variant]) -> Any:
        methods = await self.area(sinumerik.METHODS)
        for place in (methods, await self.child(methods, sinumerik.FILE_METHODS)):
            if place is not None and (found := await self.child(place, method)) is not None:
                return await place.call_method(found.nodeid, *arguments)
        raise ComputationError(f"{self._name}: the control has no method {method.text}")

    async def _folder(self, name: str) -> Node:
        folder = await self.child(await self.area(sinumerik.FILES), sinumerik.FOLDERS[name.rsplit(".", 1)[-1]])
        if folder is None:
            raise ComputationError(f"{self._name}: the control shows no folder for {name}")
        return folder

    async def _file(self, name: str) -> Node | None:
        return await self.child(await self._folder(name), name)

    async def _call(self, node: Node, method: str, *arguments: ua.Variant) -> Any:
        found = await self.child(node, method)
        if found is None:
            raise ComputationError(f"{self._name}: the control has no method {method} for files")
        return await node.call_method(found.nodeid, *arguments)

    async def _put_large(self, name: str, content: bytes, replace: bool) -> None:
        node = await self._file(name)
        if node is not None and not replace:
            raise refusal(self._name, f"writing {name}", ua.StatusCodes.BadEntryExists)
        if node is None:
            await self._call(
                await self._folder(name),
                "CreateFile",
                ua.Variant(name, ua.VariantType.String),
                ua.Variant(False, ua.VariantType.Boolean),
            )
            node = await self._file(name)
        if node is None:
            raise ComputationError(f"{self._name}: writing {name}: the control created no file")
        handle = _handle(await self._call(node, "Open", ua.Variant(_WRITE | _ERASE, ua.VariantType.Byte)))
        try:
            write = await self.child(node, "Write")
            if write is None:
                raise ComputationError(f"{self._name}: the control has no method Write for files")
            for k in range(0, len(content), _CHUNK):
                part = ua.Variant(content[k : k + _CHUNK], ua.VariantType.ByteString)
                await node.call_method(write.nodeid, handle, part)
        finally:
            with suppress(ua.UaError, OSError):
                await self._call(node, "Close", handle)
        size = await self.child(node, "Size")
        if size is not None and (found := await size.read_value()) != len(content):
            raise ComputationError(f"{self._name}: {name} has {found} of {len(content)} bytes there: write it again")

    async def _get_large(self, node: Node) -> bytes:
        handle = _handle(await self._call(node, "Open", ua.Variant(_READ, ua.VariantType.Byte)))
        content = bytearray()
        try:
            read = await self.child(node, "Read")
            if read is None:
                raise ComputationError(f"{self._name}: the control has no method Read for files")
            while part := await node.call_method(read.nodeid, handle, ua.Variant(_CHUNK, ua.VariantType.Int32)):
                content += part
        finally:
            with suppress(ua.UaError, OSError):
                await self._call(node, "Close", handle)
        return bytes(content)


def _path(name: str) -> str:
    return sinumerik.FILE_PATH(folder=sinumerik.FOLDERS[name.rsplit(".", 1)[-1]].text, name=name)


def _handle(value: Any) -> ua.Variant:
    return ua.Variant(int(value), ua.VariantType.UInt32)
