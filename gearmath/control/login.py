"""Logging in to an OPC UA server: certificates, policies, user; and its own certificate, once, to be compared."""

from __future__ import annotations

import hashlib
from contextlib import suppress
from pathlib import Path
from typing import Any

from asyncua import Client, ua
from asyncua.common.utils import ServiceError
from asyncua.crypto import security_policies
from cryptography import x509
from cryptography.hazmat.primitives import serialization

from gearmath.control import sinumerik
from gearmath.control.refusals import asked, login_refusal
from gearmath.errors import ComputationError, InputError
from gearmath.files import read_bytes
from gearmath.specs.control_connection import ControlConnection

#: What certificates for this client must name as their URI.
APPLICATION_URI = "urn:gearmath:control-client"
_POLICIES: dict[str, Any] = {
    "Basic256Sha256": security_policies.SecurityPolicyBasic256Sha256,
    "Basic256": security_policies.SecurityPolicyBasic256,
    "Basic128Rsa15": security_policies.SecurityPolicyBasic128Rsa15,
}


async def log_in(connection: ControlConnection, password: str, seconds: float) -> Client:
    """A new client with a session. ``seconds`` is how long any answer may take.

    Raises ConnectionLost where the control does not answer, ComputationError in one sentence where it refuses.
    """
    client = new_client(connection.url, seconds)
    if connection.user:
        client.set_user(connection.user)
        client.set_password(password)
    with asked(connection.name, f"connecting to {connection.url}"):
        try:
            await _secure(client, connection)
            await client.connect()
        except (ua.UaStatusCodeError, ServiceError) as error:
            await _leave(client)
            user, certificate = connection.user or "of the certificate", Path(connection.certificate).name
            raise login_refusal(connection.name, int(error.code), user, certificate, connection.security) from error
        except BaseException as error:
            await _leave(client)
            if isinstance(error, OSError | TimeoutError) and connection.security != "none":
                await _why_silent(connection, seconds)
            raise
    return client


async def _why_silent(connection: ControlConnection, seconds: float) -> None:
    """A server does not answer what it cannot decrypt: ask it, without encryption, what it would take.

    Raises ComputationError where that tells why; nobody is believed on the ground of this answer.
    """
    try:
        endpoints = await new_client(connection.url, seconds).connect_and_get_server_endpoints()
    except (ua.UaError, ServiceError, OSError, TimeoutError):
        return
    offered = {one.SecurityPolicyUri.rsplit("#", 1)[-1] for one in endpoints}
    if connection.security not in offered:
        said = ", ".join(sorted(offered))
        raise ComputationError(f"{connection.name}: security {connection.security} is not offered, but {said}")
    known = _certificate(Path(connection.server_certificate).read_bytes())
    if known.public_bytes(serialization.Encoding.DER) not in {bytes(one.ServerCertificate or b"") for one in endpoints}:
        raise ComputationError(
            f"{connection.name}: the control's certificate is another one than {connection.server_certificate}: if it "
            "was renewed, delete the file and store it anew with 'gearmath control trust'"
        )


def new_client(url: str, seconds: float) -> Client:
    """A client that is not connected yet: it keeps its session alive, and never connects again by itself."""
    client = Client(url, timeout=seconds, auto_reconnect=False)
    client.name = client.description = "gearmath"
    client.application_uri = APPLICATION_URI
    client.session_timeout = int(1000 * sinumerik.SESSION_SECONDS)
    return client


async def server_certificate(connection: ControlConnection, seconds: float) -> tuple[bytes, str]:
    """The control's own certificate (DER) as it sends it, and its SHA-256 fingerprint, for somebody to compare."""
    with asked(connection.name, f"connecting to {connection.url}"):
        endpoints = await new_client(connection.url, seconds).connect_and_get_server_endpoints()
    found = next((one.ServerCertificate for one in endpoints if one.ServerCertificate), None)
    if not found:
        raise ComputationError(f"{connection.name}: the control sends no certificate: it offers no encryption")
    return bytes(found), hashlib.sha256(found).hexdigest()


async def _secure(client: Client, connection: ControlConnection) -> None:
    if connection.security == "none":
        return
    if not connection.server_certificate or not Path(connection.server_certificate).is_file():
        raise InputError(
            f"{connection.name}: server_certificate = {connection.server_certificate!r}: there is no such file; store "
            "the control's certificate once with 'gearmath control trust' and compare its fingerprint"
        )
    _check_files(connection)
    try:
        await client.set_security(
            _POLICIES[connection.security],
            connection.certificate,
            connection.key,
            server_certificate=connection.server_certificate,
            mode=ua.MessageSecurityMode.SignAndEncrypt,
        )
        if not connection.user:
            await client.load_client_certificate(connection.certificate)
            await client.load_private_key(Path(connection.key))
    except ValueError as error:
        raise InputError(f"{connection.name}: certificate or key cannot be read: {error}") from error


def _check_files(connection: ControlConnection) -> None:
    """Certificates and key must be readable, and the key that of the certificate."""
    public = {}
    for name in ("certificate", "server_certificate", "key"):
        path = getattr(connection, name)
        content = read_bytes(Path(path))
        try:
            if name == "key":
                is_text = content.startswith(b"-----")
                read = serialization.load_pem_private_key if is_text else serialization.load_der_private_key
                public[name] = read(content, None).public_key()
            else:
                public[name] = _certificate(content).public_key()
        except (ValueError, TypeError):
            what = "private key without a password" if name == "key" else "certificate"
            raise InputError(f"{connection.name}: {name} = {path!r}: is no {what} in PEM or DER") from None
    if public["key"] != public["certificate"]:
        raise InputError(f"{connection.name}: key = {connection.key!r}: does not belong to {connection.certificate!r}")


def _certificate(content: bytes) -> x509.Certificate:
    is_text = content.startswith(b"-----")
    return (x509.load_pem_x509_certificate if is_text else x509.load_der_x509_certificate)(content)


async def _leave(client: Client) -> None:
    """Give up a client, whatever state it is in."""
    with suppress(Exception):
        client.disconnect_socket()
