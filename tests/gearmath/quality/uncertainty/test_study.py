"""Studies: the same bits whoever computes them, files that are continued, and files that are refused."""

from __future__ import annotations

import io
import multiprocessing
import os
import subprocess
import sys
import zipfile
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor

import casadi as ca
import numpy as np
import pytest

from gearmath.errors import ComputationError, InputError
from gearmath.quality.uncertainty.study import BLOCK, evaluate_batch, monte_carlo, parameter_study, run


def wave(width: int = 3, turns: float = 2.0) -> ca.Function:
    """A function without symmetry, with something smooth and something that is not."""
    x = ca.SX.sym("x", width)
    return ca.Function("wave", [x], [ca.vertcat(ca.sin(turns * x) + x**2 / 7, ca.mmax(x), ca.sumsqr(x))])


class Immediate(Executor):
    """Runs a task when it is handed in, and keeps count of what was sent."""

    def __init__(self, fails_after: int | None = None) -> None:
        self.texts: list[str | None] = []
        self.fails_after = fails_after

    def submit(self, task, /, *arguments, **named):
        future: Future = Future()
        self.texts.append(arguments[1])
        if self.fails_after is not None and len(self.texts) > self.fails_after:
            future.set_exception(KeyboardInterrupt())
        else:
            future.set_result(task(*arguments, **named))
        return future


@pytest.fixture(scope="module")
def expected() -> np.ndarray:
    return run(monte_carlo(wave(), 5 * BLOCK + 7, seed=11), workers=1)


def test_results_are_the_function_of_numbers_drawn_block_by_block(expected):
    """By NumPy alone: spawned children, one a block; the last block is drawn whole and cut."""
    children = np.random.SeedSequence(11).spawn(6)
    x = np.concatenate([np.random.default_rng(child).standard_normal((3, BLOCK)) for child in children], axis=1)
    x = x[:, : 5 * BLOCK + 7]
    by_hand = np.stack([*(np.sin(2 * x) + x**2 / 7), x.max(axis=0), (x**2).sum(axis=0)], axis=1)
    np.testing.assert_allclose(expected, by_hand, rtol=1e-14)


@pytest.mark.parametrize("workers", [2, 3, 8])
def test_threads_give_the_same_bits(expected, workers):
    np.testing.assert_array_equal(run(monte_carlo(wave(), len(expected), 11), workers=workers), expected)


@pytest.mark.parametrize("workers", [1, 3])
def test_an_executor_gives_the_same_bits(expected, workers):
    with ThreadPoolExecutor(workers) as executor:
        found = run(monte_carlo(wave(), len(expected), 11), executor, workers)
    np.testing.assert_array_equal(found, expected)


def test_processes_give_the_same_bits(expected):
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as executor:
        found = run(monte_carlo(wave(), len(expected), 11), executor, 2)
    np.testing.assert_array_equal(found, expected)


def test_a_dask_cluster_gives_the_same_bits(expected):
    """A real cluster: scheduler and two worker processes that talk over sockets."""
    distributed = pytest.importorskip("distributed", reason="needs the extra 'cluster'")
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
        client.get_executor() as executor,
    ):
        found = run(monte_carlo(wave(), len(expected), 11), executor, workers=2)
        pids = set(client.run(os.getpid).values())
    assert len(pids) == 2
    np.testing.assert_array_equal(found, expected)


def test_the_function_is_sent_only_to_workers_that_do_not_know_it():
    executor = Immediate()
    study = monte_carlo(wave(turns=3.0), 60 * BLOCK)
    run(study, executor, workers=1)
    assert sum(text is not None for text in executor.texts) <= 2  # the window of one worker
    assert len(executor.texts) > 4
    assert evaluate_batch("unknown", None, []) is None


def test_parameter_study_goes_through_its_rows_in_order():
    rows = np.random.default_rng(0).uniform(-2, 2, (3 * BLOCK + 5, 3))
    found = run(parameter_study(wave(), rows), workers=2)
    np.testing.assert_allclose(found[:, 4], (rows**2).sum(axis=1), rtol=1e-14)
    with ThreadPoolExecutor(2) as executor:
        np.testing.assert_array_equal(run(parameter_study(wave(), rows), executor, 2), found)


def test_first_draws_are_those_of_a_longer_study(expected):
    np.testing.assert_array_equal(run(monte_carlo(wave(), 40, 11)), expected[:40])


def test_progress_counts_every_column_once(expected):
    told: list[int] = []
    run(monte_carlo(wave(), len(expected), 11), workers=2, progress=told.append)
    assert sum(told) == len(expected)


def test_interrupted_study_is_continued_and_does_nothing_twice(tmp_path, expected):
    file, study = tmp_path / "r.npz", monte_carlo(wave(), len(expected), 11)
    with pytest.raises(KeyboardInterrupt):
        run(study, Immediate(fails_after=1), workers=1, file=file)
    told: list[int] = []
    second = Immediate()
    np.testing.assert_array_equal(run(study, second, 1, file, told.append), expected)
    assert told[0] >= BLOCK  # what the file brought
    assert sum(told) == len(expected)
    third = Immediate()
    np.testing.assert_array_equal(run(study, third, 1, file), expected)
    assert third.texts == []
    assert [entry.name for entry in tmp_path.iterdir()] == ["r.npz"]


def test_more_draws_continue_the_file_of_fewer(tmp_path, expected):
    file = tmp_path / "r.npz"
    run(monte_carlo(wave(), 2 * BLOCK, 11), file=file)
    told: list[int] = []
    found = run(monte_carlo(wave(), len(expected), 11), file=file, progress=told.append)
    assert told[0] == 2 * BLOCK
    np.testing.assert_array_equal(found, expected)
    np.testing.assert_array_equal(run(monte_carlo(wave(), 30, 11), file=file), expected[:30])
    np.testing.assert_array_equal(run(monte_carlo(wave(), len(expected), 11), file=file), expected)


@pytest.mark.parametrize(
    "other",
    [monte_carlo(wave(), 50, 12), monte_carlo(wave(turns=2.5), 50, 11), parameter_study(wave(), np.zeros((50, 3)))],
    ids=["seed", "function", "columns"],
)
def test_file_of_another_study_is_refused(tmp_path, other):
    file = tmp_path / "r.npz"
    run(monte_carlo(wave(), 50, 11), file=file)
    before = file.read_bytes()
    with pytest.raises(InputError, match=r"r\.npz: study = [0-9a-f]{12}\.\.\.: holds the results of another study"):
        run(other, file=file)
    assert file.read_bytes() == before


def test_file_that_is_no_results_file_is_refused(tmp_path):
    file = tmp_path / "r.npz"
    run(monte_carlo(wave(), 50, 11), file=file)
    whole = file.read_bytes()
    np.savez(tmp_path / "objects.npz", study=np.array({"a": 1}, dtype=object), done=np.zeros(1), values=np.zeros(1))
    contents = (b"", b"draws\n1,2,3\n", whole[: len(whole) // 2], (tmp_path / "objects.npz").read_bytes())
    for content in contents:
        file.write_bytes(content)
        with pytest.raises(InputError, match=r"r\.npz: is no results file of a study$"):
            run(monte_carlo(wave(), 50, 11), file=file)
        assert file.read_bytes() == content


def of_shape(shape, kind="<f8"):
    """An array as .npy text that says it is this large, and has one number."""
    stream = io.BytesIO()
    np.lib.format.write_array_header_1_0(stream, {"descr": kind, "fortran_order": False, "shape": shape})
    return stream.getvalue() + bytes(8)


@pytest.mark.parametrize(
    ("member", "content", "sentence"),
    [
        ("values", lambda raw: of_shape((10**13, 5)), "is no results file of a study"),
        ("values", lambda raw: of_shape((10**9, 5)), "is no results file of a study"),
        ("values", lambda raw: of_shape((1,), "<c16") + bytes(8), "is no results file of a study"),
        ("values", lambda raw: raw.replace(b"<f8", b"<i8"), "values are of type int64, must be float64"),
        (
            "values",
            lambda raw: raw[: -BLOCK * 5 * 8] + np.full(BLOCK * 5, np.nan).tobytes(),
            "block 0 is marked as done",
        ),
        ("done", lambda raw: of_shape((), "|b1"), "is no results file of a study"),
        ("study", lambda raw: b"text", "holds the results of another study"),
    ],
)
def test_results_file_that_lies_is_refused_and_kept(tmp_path, member, content, sentence):
    """Sizes that no memory has, other types, blocks that are said to be done and hold nothing."""
    file = tmp_path / "r.npz"
    run(monte_carlo(wave(), BLOCK, 11), file=file)
    with zipfile.ZipFile(file) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    changed = content(parts[f"{member}.npy"])
    assert changed != parts[f"{member}.npy"]
    with zipfile.ZipFile(file, "w") as archive:
        for name, raw in (parts | {f"{member}.npy": changed}).items():
            archive.writestr(name, raw)
    before = file.read_bytes()
    with pytest.raises(InputError, match=rf"r\.npz: .*({sentence})"):
        run(monte_carlo(wave(), BLOCK, 11), file=file)
    assert file.read_bytes() == before


@pytest.mark.parametrize("place", [0.1, 0.3, 0.6, 0.9])
def test_results_file_with_a_damaged_byte_is_refused(tmp_path, place):
    file = tmp_path / "r.npz"
    expected = run(monte_carlo(wave(), 50, 11), file=file)
    content = bytearray(file.read_bytes())
    content[int(place * len(content))] ^= 0x55
    file.write_bytes(content)
    try:
        np.testing.assert_array_equal(run(monte_carlo(wave(), 50, 11), file=file), expected)
    except InputError as error:
        assert "r.npz" in str(error)  # noqa: PT017


_NAME = """
import casadi as ca
from gearmath.kernels import kernel
from gearmath.quality.uncertainty.study import monte_carlo
x = ca.MX.sym("x", 12)
value, _ = kernel("deviation_surface").function(x[0], x[1], x[2:])
print(monte_carlo(ca.Function("surface", [x], [value]), 10).sha256)
"""


def test_name_of_a_study_does_not_depend_on_the_process():
    """Or a file could not be continued tomorrow: the same derivation, lowered anew with other hash seeds."""
    names = {
        subprocess.run(
            [sys.executable, "-c", _NAME], env=os.environ | {"PYTHONHASHSEED": seed}, capture_output=True, check=True
        ).stdout
        for seed in ("1", "2")
    }
    assert len(names) == 1
    assert len(names.pop().strip()) == 64


def test_broken_workers_are_a_failure_in_one_sentence():
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as executor:
        executor.submit(os._exit, 3)
        with pytest.raises(ComputationError, match=r"^the workers of the study broke down: "):
            run(monte_carlo(wave(), 20 * BLOCK), executor, 1)


def test_function_of_several_columns_is_no_study():
    x, y = ca.SX.sym("x", 2), ca.SX.sym("y")
    with pytest.raises(ValueError, match="one column"):
        monte_carlo(ca.Function("f", [x, y], [x * y]), 10)
    with pytest.raises(ValueError, match="columns of 3"):
        parameter_study(ca.Function("f", [x], [x]), np.zeros((5, 3)))
