"""Users of the simulated control: their passwords, certificates and rights, and who is calling now."""

from __future__ import annotations

import hmac
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Any

from asyncua import ua
from asyncua.crypto.permission_rules import User, UserRole

from gearmath.control import sinumerik

#: Who is calling, within one request.
NOBODY = User()
caller: ContextVar[User] = ContextVar("caller", default=NOBODY)
_USUAL = frozenset(
    (sinumerik.READ_STATE, sinumerik.WRITE_STATE, sinumerik.READ_ALARMS, sinumerik.READ_FILES, sinumerik.WRITE_FILES)
)


@dataclass
class Account:
    """One user, and what it may do."""

    password: str | None = None
    certificate: bytes | None = None
    """DER, for who identifies by certificate."""
    rights: frozenset[str] = _USUAL


@dataclass
class Access:
    """The users of a control; asyncua asks it who somebody is."""

    accounts: dict[str, Account] = field(default_factory=dict)
    operate: bool = True
    """Whether the protection level for writing files is set."""
    anonymous: bool = False

    def get_user(
        self, iserver: Any, username: str | None = None, password: str | None = None, certificate: Any = None
    ) -> User | None:
        """The user of a password or certificate; None for nobody."""
        if username is not None:
            account = self.accounts.get(username)
            known = account is not None and account.password is not None and password is not None
            if known and hmac.compare_digest(account.password.encode(), password.encode()):  # type: ignore[union-attr]
                return User(UserRole.User, username)
            return None
        for name, account in self.accounts.items():
            if certificate is not None and account.certificate == certificate:
                return User(UserRole.User, name)
        return User(UserRole.User, None) if self.anonymous else None

    def rights(self, user: User) -> frozenset[str]:
        """What a user may do."""
        account = self.accounts.get(user.name or "")
        return account.rights if account else frozenset((sinumerik.READ_STATE,)) if self.anonymous else frozenset()

    def may(self, user: User, right: str) -> bool:
        """Whether a user has a right, by itself or with all of its kind."""
        every = sinumerik.WRITE_ALL if right.endswith("Write") else sinumerik.READ_ALL
        return bool({right, every} & self.rights(user))

    def need(self, right: str) -> None:
        """Raises BadUserAccessDenied where the caller has not the right."""
        if not self.may(caller.get(), right):
            raise ua.uaerrors.BadUserAccessDenied

    def method_allowed(self) -> None:
        """Raises BadRequestNotAllowed for a caller without a name."""
        if caller.get().name is None:
            raise ua.uaerrors.BadRequestNotAllowed
