"""The results file of a study: which blocks are done, and their values; an .npz without pickled objects."""

from __future__ import annotations

import io
import os
import time
import zipfile
import zlib
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType

import numpy as np

from gearmath.errors import InputError
from gearmath.files import write_bytes

#: Writing may take this share of the time, so that a study of many gigabytes does not write more than it computes.
_SHARE = 0.1


class Results:
    """Values (blocks * size, q) of a study, row k * size + j of block k, and which blocks are done.

    A context: what is done is in the file when it is left, however it is left. Without a file it only collects. A file
    may hold more blocks than are asked for, and keeps them.
    """

    def __init__(self, path: Path | None, sha256: str, blocks: int, size: int, width: int) -> None:
        self._path, self._sha256, self._size = path, sha256, size
        self.done = np.zeros(blocks, dtype=bool)
        self.values = np.full((blocks * size, width), np.nan)
        self._asked = blocks
        self._written, self._cost, self._new = time.monotonic(), 0.0, False
        if path is not None and os.path.exists(path):
            self._load(path)

    def missing(self) -> list[int]:
        """Blocks that are asked for and not done."""
        return np.flatnonzero(~self.done[: self._asked]).tolist()

    def put(self, blocks: Sequence[int], values: np.ndarray) -> None:
        """Take the values (n,q) of some blocks; only the last block of a study may be short."""
        for k, part in zip(blocks, np.split(values, range(self._size, len(values), self._size)), strict=True):
            self.values[k * self._size : k * self._size + len(part)] = part
            self.done[k] = True
        self._new = True
        if time.monotonic() - self._written >= self._cost / _SHARE:
            self._write()

    def __enter__(self) -> Results:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._write()

    def _write(self) -> None:
        if self._path is None or not self._new:
            return
        begin, stream = time.monotonic(), io.BytesIO()
        np.savez(stream, study=np.array(self._sha256), done=self.done, values=self.values)
        write_bytes(self._path, stream.getvalue())
        self._new, self._written = False, time.monotonic()
        self._cost = self._written - begin

    def _load(self, path: Path) -> None:
        try:
            with np.load(io.BytesIO(path.read_bytes()), allow_pickle=False) as stored:
                sha256, done, values = str(stored["study"]), stored["done"], stored["values"]
        except (zipfile.BadZipFile, zlib.error, EOFError, ValueError, KeyError, TypeError) as error:
            raise InputError(f"{path}: is no results file of a study") from error
        except (MemoryError, NotImplementedError, RuntimeError) as error:  # sizes, methods and passwords of the archive
            raise InputError(f"{path}: is no results file of a study: {error}") from error
        except OSError as error:
            raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error
        if sha256 != self._sha256:
            raise InputError(
                f"{path}: study = {sha256[:12]}...: holds the results of another study, this one is "
                f"{self._sha256[:12]}...; take another name, or delete the file"
            )
        width = self.values.shape[1]
        if done.dtype != bool or done.ndim != 1 or values.shape != (len(done) * self._size, width):
            raise InputError(f"{path}: is no results file of a study")
        if values.dtype != np.float64:
            raise InputError(f"{path}: values are of type {values.dtype}, must be float64")
        known = np.isfinite(values.reshape(len(done), self._size, width)).any(axis=(1, 2))
        if (done & ~known).any():
            raise InputError(f"{path}: block {int(np.argmax(done & ~known))} is marked as done and holds no numbers")
        if len(done) > len(self.done):
            self.done, self.values = done, values
        else:
            self.done[: len(done)], self.values[: len(values)] = done, values
