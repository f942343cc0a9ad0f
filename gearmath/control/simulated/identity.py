"""Certificates of a simulated control and of a client that it trusts, in one folder, with the file that names them."""

from __future__ import annotations

from pathlib import Path

from asyncua.crypto.cert_gen import setup_self_signed_certificate
from cryptography import x509
from cryptography.hazmat.primitives.serialization import Encoding
from cryptography.x509.oid import ExtendedKeyUsageOID

from gearmath.control.login import APPLICATION_URI
from gearmath.control.simulated.server import URI, Identity
from gearmath.errors import InputError
from gearmath.files import write_bytes, write_text

_CONNECTION = """# The simulated control, as 'gearmath control simulate' made it.
name = "simulated control"
url = "{url}"
user = "operator"
certificate = "client.der"
key = "client_key.pem"
server_certificate = "control.der"
"""


async def prepared(folder: Path, url: str, user: str = "operator") -> Identity:
    """The certificates in ``folder``, made where they are missing, and a ``control.toml`` that names them."""
    trusted = folder / "trusted"
    try:
        trusted.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be used: {error.strerror}") from error
    await made(folder / "control_key.pem", folder / "control.der", URI, ExtendedKeyUsageOID.SERVER_AUTH)
    await made(folder / "client_key.pem", folder / "client.der", APPLICATION_URI, ExtendedKeyUsageOID.CLIENT_AUTH)
    write_bytes(trusted / "client.der", (folder / "client.der").read_bytes())
    write_text(folder / "control.toml", _CONNECTION.format(url=url).replace('"operator"', f'"{user}"'))
    return Identity(folder / "control.der", folder / "control_key.pem", trusted)


async def made(key: Path, certificate: Path, uri: str, use: x509.ObjectIdentifier) -> None:
    """A self-signed certificate (DER) for an application, with its key; nothing where they are there and go on."""
    await setup_self_signed_certificate(key, certificate, uri, "localhost", [use], {"organizationName": "gearmath"})
    content = certificate.read_bytes()
    if content.startswith(b"-----"):
        write_bytes(certificate, x509.load_pem_x509_certificate(content).public_bytes(Encoding.DER))
    key.chmod(0o600)
