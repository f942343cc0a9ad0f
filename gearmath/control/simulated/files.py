"""Files of the simulated control: the copy methods in both of their homes, and file objects with FileType methods."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from asyncua import Server, ua
from asyncua.common.node import Node

from gearmath.control import sinumerik
from gearmath.control.simulated.access import Access
from gearmath.control.simulated.nc import Nc
from gearmath.control.ua_words import node_id, status

_READ, _WRITE, _ERASE = 1, 2, 4
_CODES = ua.StatusCodes
_PREFIX = "Sinumerik/FileSystem/"


class _Refused(Exception):
    def __init__(self, code: int) -> None:
        self.code = code


@dataclass
class _Open:
    path: str
    content: bytearray
    writing: bool
    at: int = field(default=0)


class FileMethods:
    """The methods of files, and the folders and file objects that are browsed for."""

    def __init__(self, server: Server, nc: Nc, access: Access, index: int) -> None:
        self.server, self.nc, self.access, self.index = server, nc, access, index
        self._folders: dict[str, Node] = {}
        self._objects: set[str] = set()
        self._open: dict[int, _Open] = {}
        self._handles = itertools.count(1)

    async def build(self, root: Node, methods: Node, homes: tuple[str, ...]) -> None:
        """Folders below ``root``, and the copy methods in their ``homes``, ``old``, ``new`` or both."""
        system = await self._object(root, sinumerik.FILES.text, f"{sinumerik.ROOT.text}/{sinumerik.FILES.text}")
        for folder in sinumerik.FOLDERS.values():
            node = await self._object(system, folder.text, f"{_PREFIX}{folder.text}")
            self._folders[folder.text] = node
            await self._method(
                node,
                f"{_PREFIX}{folder.text}.CreateFile",
                "CreateFile",
                self._create,
                [ua.VariantType.String, ua.VariantType.Boolean],
                [ua.VariantType.NodeId, ua.VariantType.UInt32],
            )
            await self._method(
                node, f"{_PREFIX}{folder.text}.Delete", "Delete", self._delete, [ua.VariantType.NodeId], []
            )
        for home in homes:
            place, path = methods, f"/{sinumerik.METHODS.text}"
            if home == "new":
                path += f"/{sinumerik.FILE_METHODS.text}"
                place = await self._object(methods, sinumerik.FILE_METHODS.text, path)
            for name, call, takes, gives in (
                (
                    sinumerik.COPY_TO.text,
                    self._copy_to,
                    [ua.VariantType.String, ua.VariantType.ByteString, ua.VariantType.Boolean],
                    [],
                ),
                (sinumerik.COPY_FROM.text, self._copy_from, [ua.VariantType.String], [ua.VariantType.ByteString]),
            ):
                await self._method(place, f"{path}/{name}", name, call, takes, gives, self.index)
        await self.refresh()

    async def refresh(self) -> None:
        """A file object for every file, and for no other."""
        for path in self._objects - set(self.nc.files):
            self._objects.discard(path)
            await self.server.delete_nodes([self.server.get_node(node_id(_PREFIX + path, self.index))], recursive=True)
        for path in list(self.nc.files):
            if path not in self._objects:
                self._objects.add(path)
                await self._file_object(path)

    async def _object(self, parent: Node, name: str, identifier: str) -> Node:
        return await parent.add_object(
            node_id(identifier, self.index), ua.QualifiedName(name, self.index), ua.ObjectIds.FolderType
        )

    async def _method(
        self,
        parent: Node,
        identifier: str,
        name: str,
        call: Callable[..., Any],
        takes: list,
        gives: list,
        space: int = 0,
    ) -> None:
        """A method whose refusals become status codes; those of the standard have their names in its namespace, 0."""

        async def answer(_: ua.NodeId, *arguments: ua.Variant) -> ua.CallMethodResult:
            try:
                self.access.method_allowed()
                values = await call(*(argument.Value for argument in arguments))
            except _Refused as refused:
                return ua.CallMethodResult(StatusCode=status(refused.code))
            except ua.UaStatusCodeError as refused:
                return ua.CallMethodResult(StatusCode=status(refused.code))
            found = [ua.Variant(value, kind) for value, kind in zip(values, gives, strict=True)]
            return ua.CallMethodResult(OutputArguments=found)

        await parent.add_method(node_id(identifier, self.index), ua.QualifiedName(name, space), answer, takes, gives)

    async def _file_object(self, path: str) -> None:
        folder, name = path.rsplit("/", 1)
        if folder not in self._folders:
            return
        identifier = f"{_PREFIX}{path}"
        node = await self._folders[folder].add_object(
            node_id(identifier, self.index), ua.QualifiedName(name, self.index), ua.ObjectIds.FileType
        )
        for child in await node.get_children():  # those of the type, which do nothing
            await self.server.delete_nodes([child])
        u32, i32, data = ua.VariantType.UInt32, ua.VariantType.Int32, ua.VariantType.ByteString

        async def opened(mode: int) -> list:
            return [self._opened(path, mode)]

        for method, call, takes, gives in (
            ("Open", opened, [ua.VariantType.Byte], [u32]),
            ("Read", self._read, [u32, i32], [data]),
            ("Write", self._write, [u32, data], []),
            ("Close", self._close, [u32], []),
            ("GetPosition", self._tell, [u32], [ua.VariantType.UInt64]),
            ("SetPosition", self._seek, [u32, ua.VariantType.UInt64], []),
        ):
            await self._method(node, f"{identifier}.{method}", method, call, takes, gives)
        size = await node.add_property(
            node_id(f"{identifier}.Size", self.index), ua.QualifiedName("Size", 0), 0, ua.VariantType.UInt64
        )
        flag, count = ua.VariantType.Boolean, ua.VariantType.UInt16
        for name, value, kind in (("Writable", True, flag), ("UserWritable", True, flag), ("OpenCount", 0, count)):
            await node.add_property(node_id(f"{identifier}.{name}", self.index), ua.QualifiedName(name, 0), value, kind)

        def measured(nodeid: ua.NodeId, attribute: ua.AttributeIds) -> ua.DataValue:
            return ua.DataValue(ua.Variant(len(self.nc.files.get(path, b"")), ua.VariantType.UInt64))

        self.server.set_attribute_value_callback(size.nodeid, measured)

    # methods

    async def _copy_to(self, target: str, content: bytes, overwrite: bool) -> list:
        self._may_write()
        path = _checked(target)
        if len(content) > sinumerik.COPY_LIMIT:
            raise _Refused(_CODES.BadRequestTooLarge)
        if path in self.nc.files and not overwrite:
            raise _Refused(_CODES.BadEntryExists)
        self._keep(path, bytes(content))
        await self.refresh()
        return []

    async def _copy_from(self, source: str) -> list:
        self.access.need(sinumerik.READ_FILES)
        content = self._content(_checked(source))
        if len(content) > sinumerik.COPY_LIMIT:
            raise _Refused(_CODES.BadResponseTooLarge)
        return [content]

    async def _create(self, name: str, opening: bool) -> list:
        self._may_write()
        folder = sinumerik.FOLDERS[name.rsplit(".", 1)[-1]].text if "." in name else ""
        path = _checked(f"{_PREFIX}{folder}/{name}")
        if path in self.nc.files:
            raise _Refused(_CODES.BadBrowseNameDuplicated)
        self._keep(path, b"")
        await self.refresh()
        return [node_id(_PREFIX + path, self.index), self._opened(path, _WRITE) if opening else 0]

    async def _delete(self, node: ua.NodeId) -> list:
        self._may_write()
        path = _checked(str(node.Identifier))
        self._content(path)
        if path == self.nc.selected:
            raise _Refused(_CODES.BadNotWritable)
        del self.nc.files[path]
        await self.refresh()
        return []

    def _opened(self, path: str, mode: int) -> int:
        if mode & _WRITE:
            self._may_write()
            if any(one.path == path and one.writing for one in self._open.values()):
                raise _Refused(_CODES.BadNotWritable)
        else:
            self.access.need(sinumerik.READ_FILES)
        handle = next(self._handles)
        content = bytearray() if mode & _ERASE else bytearray(self._content(path))
        self._open[handle] = _Open(path, content, bool(mode & _WRITE))
        if mode & _ERASE:
            self._keep(path, b"")
        return handle

    async def _read(self, handle: int, length: int) -> list:
        one = self._handle(handle)
        part = bytes(one.content[one.at : one.at + length])
        one.at += len(part)
        return [part]

    async def _write(self, handle: int, content: bytes) -> list:
        one = self._handle(handle)
        if not one.writing:
            raise _Refused(_CODES.BadInvalidState)
        one.content[one.at : one.at + len(content)] = content
        one.at += len(content)
        return []

    async def _close(self, handle: int) -> list:
        one = self._handle(handle)
        del self._open[handle]
        if one.writing:
            self._keep(one.path, bytes(one.content))
        return []

    async def _tell(self, handle: int) -> list:
        return [self._handle(handle).at]

    async def _seek(self, handle: int, at: int) -> list:
        self._handle(handle).at = at
        return []

    def _handle(self, handle: int) -> _Open:
        if handle not in self._open:
            raise _Refused(_CODES.BadInvalidArgument)
        return self._open[handle]

    def _content(self, path: str) -> bytes:
        if path not in self.nc.files:
            raise _Refused(_CODES.BadNotFound)
        return self.nc.files[path]

    def _keep(self, path: str, content: bytes) -> None:
        if self.nc.channel and path == self.nc.selected:
            raise _Refused(_CODES.BadNotWritable)
        self.nc.files[path] = content

    def _may_write(self) -> None:
        self.access.need(sinumerik.WRITE_FILES)
        if not self.access.operate:
            raise _Refused(_CODES.BadNotSupported)


def _checked(target: str) -> str:
    """``folder/NAME.MPF`` of a path; the control refuses two extensions, and anything beside the folders."""
    folder, _, name = target.removeprefix(_PREFIX).rpartition("/")
    stem, _, kind = name.partition(".")
    if folder not in {one.text for one in sinumerik.FOLDERS.values()} or not stem or kind not in sinumerik.FOLDERS:
        raise _Refused(_CODES.BadInvalidArgument)
    return f"{folder}/{name}"
