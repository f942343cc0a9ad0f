"""Studies: one function of one column of numbers, evaluated for many columns, wherever there are processors.

The columns are drawn (Monte Carlo) or given (a parameter study), and are cut into blocks of fixed size. Block k of a
Monte Carlo study draws from child k of ``SeedSequence(seed)``, so that what comes out does not depend on who computes
which block and when. Several blocks make a batch, so that handing it out costs little beside computing it; a results
file is rewritten as batches come in, and a study that finds such a file continues it.
"""

from __future__ import annotations

import hashlib
import math
import os
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import casadi as ca
import numpy as np

from gearmath.errors import ComputationError
from gearmath.quality.uncertainty.study_file import Results

#: Columns of a block: one seed, one part of the results file. Another size would be another study.
BLOCK = 250
#: A batch takes about this long, or the handing out would take its share. [s]
_BATCH_SECONDS = 1.0
#: Batches for each worker at least, so that none waits for the last.
_BATCHES_PER_WORKER = 4


@dataclass(frozen=True)
class Drawn:
    """Columns of ``width`` independent standard normal numbers."""

    width: int
    count: int
    seed: int

    @property
    def key(self) -> bytes:
        """What makes the columns what they are. Not their number: more draws continue the same study."""
        return f"standard normal, width {self.width}, seed {self.seed}, blocks of {BLOCK}".encode()

    def block(self, k: int) -> DrawBlock:
        return DrawBlock(k, self.width, self.seed, None)


@dataclass(frozen=True)
class Given:
    """Columns of a parameter study, as rows (n,width)."""

    rows: np.ndarray

    @property
    def width(self) -> int:
        return self.rows.shape[1]

    @property
    def count(self) -> int:
        return len(self.rows)

    @property
    def key(self) -> bytes:
        return f"given, {self.rows.shape}, blocks of {BLOCK}".encode() + np.ascontiguousarray(self.rows).tobytes()

    def block(self, k: int) -> DrawBlock:
        return DrawBlock(k, self.width, 0, self.rows[k * BLOCK : (k + 1) * BLOCK])


@dataclass(frozen=True)
class DrawBlock:
    """One block, small enough to be sent: where its columns come from, or the columns themselves."""

    number: int
    width: int
    seed: int
    rows: np.ndarray | None

    def columns(self) -> np.ndarray:
        """(width, n)."""
        if self.rows is not None:
            return np.ascontiguousarray(self.rows.T)
        child = np.random.SeedSequence(self.seed, spawn_key=(self.number,))  # what spawn() makes as child ``number``
        return np.random.default_rng(child).standard_normal((self.width, BLOCK))


@dataclass(frozen=True)
class Study:
    """A function of one column (p,) with one column (q,) of results, and the columns to evaluate it for."""

    function: ca.Function
    columns: Drawn | Given

    def __post_init__(self) -> None:
        if self.function.n_in() != 1 or self.function.n_out() != 1:
            raise ValueError(f"{self.function.name()}: a study needs a function of one column with one column out")
        if self.function.size_in(0) != (self.columns.width, 1) or self.function.size2_out(0) != 1:
            raise ValueError(
                f"{self.function.name()} takes {self.function.size_in(0)}, the study has columns of "
                f"{self.columns.width}"
            )

    @property
    def sha256(self) -> str:
        """Name of the study: of the function with all its constants, the columns or their seed, and the block size."""
        text = self.function.serialize().encode()
        return hashlib.sha256(b"gearmath study 1\n" + text + b"\n" + self.columns.key).hexdigest()

    @property
    def blocks(self) -> int:
        return math.ceil(self.columns.count / BLOCK)


def monte_carlo(function: ca.Function, count: int, seed: int = 0) -> Study:
    """The study of ``function`` for ``count`` columns of independent standard normal numbers."""
    return Study(function, Drawn(function.size1_in(0), count, seed))


def parameter_study(function: ca.Function, rows: np.ndarray) -> Study:
    """The study of ``function`` for the given columns, one in each row (n,p)."""
    return Study(function, Given(np.asarray(rows, dtype=float)))


def run(
    study: Study,
    executor: Executor | None = None,
    workers: int | None = None,
    file: Path | None = None,
    progress: Callable[[int], object] = lambda _: None,
) -> np.ndarray:
    """Results (n,q) of a study, row by row those of its columns, the same to the bit however they are computed.

    Without ``executor`` the batches run on ``Function.map`` in ``workers`` threads; with one, its workers compute them,
    and ``workers`` says how many there are (default: the processors of this computer). ``file`` keeps what is done;
    ``progress`` is told the number of columns done. Raises InputError if the file is of another study, and
    ComputationError if the workers break down.
    """
    workers = workers or os.cpu_count() or 1
    # the name of a study takes as long as a small one
    with Results(file, study.sha256 if file else "", study.blocks, BLOCK, study.function.size1_out(0)) as results:
        missing = results.missing()
        progress(study.columns.count - sum(len(_rows(study, k)) for k in missing))
        computed = _computed(study, missing, executor, workers)
        for blocks, values in computed:
            results.put(blocks, values)
            progress(sum(len(_rows(study, k)) for k in blocks))
        return results.values[: study.columns.count].copy()


def _rows(study: Study, k: int) -> range:
    return range(k * BLOCK, min((k + 1) * BLOCK, study.columns.count))


def _computed(
    study: Study, missing: Sequence[int], executor: Executor | None, workers: int
) -> Iterator[tuple[Sequence[int], np.ndarray]]:
    """Batches of blocks with their values (n,q), as they get ready. The first block, done here, tells the pace."""
    if not missing:
        return
    begin = time.perf_counter()
    yield missing[:1], _evaluate(study.function, [study.columns.block(missing[0])])
    pace = time.perf_counter() - begin
    rest = missing[1:]
    most = math.ceil(len(rest) / (_BATCHES_PER_WORKER * workers))
    size = max(1, min(most, math.ceil(_BATCH_SECONDS / pace)))
    batches = [rest[k : k + size] for k in range(0, len(rest), size)]
    if executor is None:
        for blocks in batches:
            yield blocks, _evaluate(study.function, [study.columns.block(k) for k in blocks], workers)
    else:
        yield from _Dispatch(study, executor, 2 * workers).run(batches)


class _Dispatch:
    """Hands batches to an executor, at most ``window`` at a time.

    An executor does not say which worker takes what. So a task names the function by its digest only; a worker that
    does not know it says so, and gets the same batch once more with the function's text.
    """

    def __init__(self, study: Study, executor: Executor, window: int) -> None:
        self.study, self.executor, self.window = study, executor, window
        self.text = study.function.serialize()
        self.digest = hashlib.sha256(self.text.encode()).hexdigest()
        self.pending: dict[Future, Sequence[int]] = {}

    def _submit(self, blocks: Sequence[int], text: str | None) -> None:
        parts = [self.study.columns.block(k) for k in blocks]
        self.pending[self.executor.submit(evaluate_batch, self.digest, text, parts)] = blocks

    def run(self, batches: list[Sequence[int]]) -> Iterator[tuple[Sequence[int], np.ndarray]]:
        waiting = iter(batches)
        try:
            for _, blocks in zip(range(self.window), waiting, strict=False):
                self._submit(blocks, None)
            while self.pending:
                done, _ = wait(self.pending, return_when=FIRST_COMPLETED)
                for future in done:
                    blocks, values = self.pending.pop(future), future.result()
                    if values is None:
                        self._submit(blocks, self.text)
                        continue
                    if (following := next(waiting, None)) is not None:
                        self._submit(following, None)
                    yield blocks, values
        except BrokenExecutor as error:
            raise ComputationError(f"the workers of the study broke down: {error}") from error
        finally:
            for future in self.pending:
                future.cancel()


_KNOWN: dict[str, ca.Function] = {}


def evaluate_batch(digest: str, text: str | None, blocks: Sequence[DrawBlock]) -> np.ndarray | None:
    """What a worker does: values (n,q) of some blocks; None if it does not know the function and gets no text."""
    function = _KNOWN.get(digest)
    if function is None:
        if text is None:
            return None
        function = ca.Function.deserialize(text)
        _KNOWN.clear()  # of an earlier study
        _KNOWN[digest] = function
    return _evaluate(function, blocks)


def _evaluate(function: ca.Function, blocks: Sequence[DrawBlock], threads: int = 1) -> np.ndarray:
    columns = np.concatenate([block.columns() for block in blocks], axis=1)
    return np.ascontiguousarray(np.asarray(_mapped(function, columns.shape[1], threads)(columns)).T)


@lru_cache(maxsize=16)
def _mapped(function: ca.Function, n: int, threads: int) -> ca.Function:
    return function.map(n, "thread", threads) if threads > 1 else function.map(n)
