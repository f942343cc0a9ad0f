"""Exceptions: input that a person can correct, and work that failed; counts in their sentences."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from derivations.errors import InputError as InputError


class CallError(InputError, TypeError):
    """A call with an argument that there is not, or without one that is needed: Python's own error of it, too."""


class ComputationError(RuntimeError):
    """Work that failed on good input: an iteration did not converge, a compiler is missing (exit status 1)."""


@contextmanager
def about(file: Path | None) -> Iterator[None]:
    """Names the file that an error is about, where what computes with its content cannot know it.

    Nothing is named where the content came out of no file.
    """
    try:
        yield
    except (InputError, ComputationError) as error:
        words, kind = str(error), InputError if isinstance(error, InputError) else ComputationError
        if file is None or words.startswith((f"{file}: ", f"{file}, ")):
            raise
        raise kind(f"{file}: {words}") from error


def counted(count: int, noun: str) -> str:
    """A count with its noun, as sentences have it.

    >>> counted(1, "touch"), counted(3, "touch"), counted(2, "tooth")
    ('1 touch', '3 touches', '2 teeth')
    """
    plural = "teeth" if noun == "tooth" else noun + ("es" if noun.endswith("ch") else "s")
    return f"{count} {noun if count == 1 else plural}"
