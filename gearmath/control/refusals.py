"""What an OPC UA server refuses, in one sentence each."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from contextlib import contextmanager

from asyncua import ua
from asyncua.common.utils import ServiceError

from gearmath.control.interface import ConnectionLost, NoSession
from gearmath.control.ua_words import status
from gearmath.errors import ComputationError

_CODES = ua.StatusCodes
#: The connection, or the session, is gone: asking again with a new one may help.
_LOST = {
    _CODES.BadConnectionClosed,
    _CODES.BadSessionClosed,
    _CODES.BadSessionIdInvalid,
    _CODES.BadSecureChannelClosed,
    _CODES.BadSecureChannelIdInvalid,
    _CODES.BadSessionNotActivated,
    _CODES.BadServerHalted,
    _CODES.BadShutdown,
    _CODES.BadTimeout,
    _CODES.BadCommunicationError,
    _CODES.BadNoCommunication,
    _CODES.BadNotConnected,
    _CODES.BadServerNotConnected,
    _CODES.BadDisconnect,
    _CODES.BadTcpInternalError,
    _CODES.BadInvalidState,
}
_FULL = {_CODES.BadTooManySessions, _CODES.BadMaxConnectionsReached}
_LOGIN = {
    _CODES.BadUserAccessDenied: "user {user!r} is refused: user or password is wrong",
    _CODES.BadIdentityTokenRejected: "the way of logging in is refused: user {user!r} is not known by this",
    _CODES.BadIdentityTokenInvalid: "user {user!r} is refused: user or password is wrong",
    _CODES.BadCertificateTimeInvalid: "the certificate {certificate} is out of date by the control's clock: "
    "compare its dates with the clock of the control and of this computer",
    _CODES.BadCertificateUntrusted: "the certificate {certificate} is unknown: add it to the control's trust list",
    _CODES.BadCertificateInvalid: "the certificate {certificate} is refused as not valid",
    _CODES.BadCertificateUriInvalid: "the certificate {certificate} names another application than gearmath does",
    _CODES.BadCertificateUseNotAllowed: "the certificate {certificate} is not made for a client",
    _CODES.BadSecurityPolicyRejected: "security {security} is not offered",
    _CODES.BadSecurityChecksFailed: "the certificates are refused: check clock, dates, trust list and policy, and that "
    "server_certificate is the control's own",
}


@contextmanager
def asked(name: str, what: str, right: str = "") -> Iterator[None]:
    """Makes every failure within a ConnectionLost or a ComputationError that says what was asked."""
    try:
        yield
    except (ua.UaStatusCodeError, ServiceError) as error:
        raise refusal(name, what, int(error.code), right) from error
    except (TimeoutError, OSError, asyncio.IncompleteReadError, EOFError) as error:
        raise ConnectionLost(f"{name}: no answer ({what})") from error
    except asyncio.CancelledError:
        current = asyncio.current_task()
        if current is not None and current.cancelling():
            raise
        raise ConnectionLost(f"{name}: the connection broke ({what})") from None
    except ua.UaError as error:
        if str(error).startswith("No matching endpoints"):
            raise ComputationError(f"{name}: {what}: this security is not offered") from error
        raise ComputationError(f"{name}: {what}: {' '.join(str(error).split()) or type(error).__name__}") from error


def refusal(name: str, what: str, code: int, right: str = "") -> ComputationError:
    """The error of a status code."""
    if code in _FULL:
        return NoSession(f"{name}: the control has no session left: close another client, or wait a minute")
    if code in _LOST:
        return ConnectionLost(f"{name}: the connection is lost ({what})")
    if code == _CODES.BadUserAccessDenied and right:
        return ComputationError(f"{name}: {what} is refused: the user lacks the right {right}")
    if code == _CODES.BadTooManySubscriptions:
        return NoSession(f"{name}: {what} is refused: the control has no subscription left: wait a minute")
    return ComputationError(f"{name}: {what} is refused: {code_name(code)}")


def code_name(code: int) -> str:
    """The name of a status code, and for some of them what it means on this control."""
    hint = {
        _CODES.BadNotSupported: ": the protection level for writing files is not set on the control",
        _CODES.BadNotFound: ": there is no such file",
        _CODES.BadEntryExists: ": there is such a file already",
        _CODES.BadNotWritable: ": it is in use",
    }.get(code, "")  # type: ignore[call-overload]
    return f"{status(code).name}{hint}"


def login_refusal(name: str, code: int, user: str, certificate: str, security: str) -> ComputationError:
    """The error of a status code while logging in."""
    if code in _LOGIN:
        said = _LOGIN[code].format(user=user, certificate=certificate, security=security)  # type: ignore[index]
        return ComputationError(f"{name}: {said}")
    return refusal(name, "logging in", code)
