"""How a machine control is reached: where it is, who logs in, with which certificates. It holds no password."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self
from urllib.parse import urlsplit

from pydantic import Field, field_validator, model_validator

from gearmath.errors import InputError
from gearmath.specs.toml import Spec, load

_Axis = Annotated[int, Field(strict=True, ge=1, le=31)]
#: Policies of OPC UA by their names; only the first is taken without being asked for by --insecure.
Policy = Literal["Basic256Sha256", "Basic256", "Basic128Rsa15", "none"]


class _HasPassword(Exception):
    """There is a password in a file."""


class ControlConnection(Spec):
    """One control over OPC UA. Files are relative to the folder of this one."""

    name: str = Field(min_length=1, max_length=60)
    url: str = Field(max_length=200)
    user: str = Field(default="", max_length=60)
    """Empty: the certificate says who logs in."""
    security: Policy = "Basic256Sha256"
    certificate: str = Field(default="", max_length=200)
    """DER or PEM of this client, and its key."""
    key: str = Field(default="", max_length=200)
    server_certificate: str = Field(default="", max_length=200)
    """DER of the control, as ``gearmath control trust`` stores it."""
    channel: int = Field(default=1, ge=1, le=10)
    axes: Annotated[tuple[_Axis, _Axis, _Axis, _Axis, _Axis], Field(strict=False)] = (1, 2, 3, 4, 5)
    """Numbers of the machine axes X Y Z A B."""

    @classmethod
    def from_file(cls, values: Mapping[str, Any]) -> Self:
        if "password" in values:
            raise _HasPassword
        return super().from_file(values)

    @field_validator("url")
    @classmethod
    def _is_opc(cls, url: str) -> str:
        parts = urlsplit(url)
        try:
            usable = parts.scheme == "opc.tcp" and bool(parts.hostname) and (parts.port is None or parts.port > 0)
        except ValueError:
            usable = False
        if not usable and "@" not in url:
            raise ValueError("must be like opc.tcp://192.168.0.10:4840")
        return url

    @model_validator(mode="after")
    def _complete(self) -> ControlConnection:
        if self.security != "none":
            for key in ("certificate", "key"):
                if not getattr(self, key):
                    raise ValueError(f"{key} is missing: security {self.security} needs it")
        elif not self.user:
            raise ValueError("user is missing: without security nothing else says who logs in")
        if len(set(self.axes)) != len(self.axes):
            raise ValueError("axes must be five different numbers")
        return self


def load_control_connection(path: Path) -> ControlConnection:
    """Read a connection file; its files become paths. Raises InputError naming file, key, value and limit."""
    try:
        connection = load(path, ControlConnection)
    except _HasPassword:  # not shown
        raise InputError(f"{path}: password: must not be in a file; the command asks for it") from None
    if "@" in connection.url:  # not shown: there may be a password in it
        raise InputError(f"{path}: url: must hold neither user nor password, and be like opc.tcp://192.168.0.10:4840")
    paths = {}
    for key in ("certificate", "key", "server_certificate"):
        if value := getattr(connection, key):
            paths[key] = str(path.parent / value)
            if key != "server_certificate" and not os.path.isfile(paths[key]):
                raise InputError(f"{path}: {key} = {value!r}: there is no such file")
    return connection.model_copy(update=paths)
