"""What a check of a pair raises where settings do not cut what the file says; the blame is found later."""

from __future__ import annotations


class Misfit(Exception):
    """Settings that do not cut what the file says. ``where`` names the flanks (member, flank) that may be to blame."""

    def __init__(self, what: str, *where: tuple[str, str]) -> None:
        super().__init__(what)
        self.where = where

    @classmethod
    def of(cls, member: str, flank: str, what: str) -> Misfit:
        """The misfit of one flank."""
        return cls(f"{member} {flank} flank: {what}", (member, flank))
