"""Node ids and status codes: plain numbers and texts here, kinds of their own in asyncua."""

from __future__ import annotations

from typing import Any

from asyncua import ua


def node_id(identifier: str | int, index: int = 0) -> ua.NodeId:
    """The id of a node: a text in a namespace, or a number of the standard."""
    value: Any = identifier
    space: Any = index
    return ua.NodeId(value, space)


def status(code: int = 0) -> ua.StatusCode:
    """A status code by its number."""
    value: Any = code
    return ua.StatusCode(value)
