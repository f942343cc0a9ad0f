"""The measurement store: what it keeps, what it refuses, and that nothing of it changes."""

from __future__ import annotations

import sqlite3
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from gearmath.control import interface
from gearmath.control.interface import Alarm, RunStart, Touch
from gearmath.control.store import MeasurementStore
from gearmath.control.store_schema import APPLICATION_ID, VERSION, prepare
from gearmath.errors import ComputationError, InputError

DATA = Path(__file__).parent / "data"
Start = Callable[..., RunStart]
Touched = Callable[[int], Touch]


def test_a_run_is_read_back_as_it_was_begun(store: MeasurementStore, start: Start, touch: Touched) -> None:
    begun = start(8)
    run: interface.Run = store.begin_run(begun)
    run.commit_touch(1, touch(1))
    run.add_alarm(Alarm("65001#1", "65001", "touched nothing", 1000, True, "12:00"))
    with MeasurementStore.open(store.path) as again:
        read = again.run(run.id)
        assert read.start == begun
        assert read.touches() == {1: touch(1)}
        assert read.missing() == [2, 3, 4, 5, 6, 7, 8]
        assert read.alarms() == [Alarm("65001#1", "65001", "touched nothing", 1000, True, "12:00")]


def test_touches_of_a_calibration_are_kept_with_their_targets(store: MeasurementStore, start: Start) -> None:
    columns = ("run", "point", "target", "X", "Y", "Z", "A", "B", "triggered")
    begun = start(columns=columns, points={1: ("ring_x_low",), 2: ("ring_x_high",)})
    run = store.begin_run(begun)
    assert store.run(run.id).start == begun


def test_a_point_is_kept_once(store: MeasurementStore, start: Start, touch: Touched) -> None:
    run = store.begin_run(start(8))
    run.commit_touch(3, touch(3))
    with pytest.raises(InputError, match=r"run 1, point 3: is kept already"):
        run.commit_touch(3, touch(4))
    assert run.touches() == {3: touch(3)}


def test_one_of_two_processes_that_offer_the_same_point_is_refused(
    store: MeasurementStore, start: Start, touch: Touched
) -> None:
    first = store.begin_run(start(8))
    with MeasurementStore.open(store.path) as other:
        second = other.resume_run(first.id)
        first.commit_touch(1, touch(1))
        with pytest.raises(InputError, match="is kept already"):
            second.commit_touch(1, touch(1))
        second.commit_touch(2, touch(2))
    assert list(first.touches()) == [1, 2]


@pytest.mark.parametrize(
    ("point", "values", "why"),
    [
        (9, (1, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0), "is no point of this run, which has 8"),
        (0, (1, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0), "is no point"),
        (1, (1, float("nan"), 0.0, 0.0, 0.0, 0.0, 1.0), "is no touch"),
        (1, (1, 0.0, 0.0, float("inf"), 0.0, 0.0, 1.0), "is no touch"),
        (1, (1, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0), "is no touch"),
    ],
)
def test_what_is_no_touch_of_the_run_is_refused_and_nothing_is_kept(
    store: MeasurementStore, start: Start, point: int, values: tuple, why: str
) -> None:
    run = store.begin_run(start(8))
    with pytest.raises(InputError, match=why):
        run.commit_touch(point, Touch(*values))
    assert run.touches() == {}


def test_a_complete_run_takes_no_more(store: MeasurementStore, start: Start, touch: Touched) -> None:
    run = store.begin_run(start(1))
    with pytest.raises(ComputationError, match="1 of 1 points have no touch, the first is 1"):
        run.finish("complete")
    run.commit_touch(1, touch(1))
    run.finish("complete")
    with pytest.raises(InputError, match="run 1 is complete: there is nothing to resume"):
        store.resume_run(run.id)
    with pytest.raises(ComputationError, match="the run is complete"):
        store.execute("INSERT INTO planned VALUES (1, 2, NULL, NULL, NULL, NULL, NULL, 'ring_face')")


def test_a_run_that_ended_otherwise_is_resumed_at_its_first_missing_point(
    store: MeasurementStore, start: Start, touch: Touched
) -> None:
    run = store.begin_run(start(8))
    for point in (1, 2, 3):
        run.commit_touch(point, touch(point))
    run.finish("alarm 65001: touched nothing")
    resumed = store.resume_run(run.id)
    assert resumed.missing()[0] == 4
    for point in resumed.missing():
        resumed.commit_touch(point, touch(point))
    resumed.finish("complete")
    assert store.run(run.id).touches() == {point: touch(point) for point in range(1, 9)}


def test_points_are_probed_again_in_a_run_that_refers_to_the_old_one(
    store: MeasurementStore, start: Start, touch: Touched
) -> None:
    old = store.begin_run(start(8))
    points = {k: start(8).points[k] for k in (3, 5)}
    new = store.begin_run(start(points=points, refers_to=old.id))
    assert (new.missing(), store.run(new.id).start.refers_to) == ([3, 5], old.id)
    with pytest.raises(InputError, match="there is no run 99: it has 1 to 2"):
        store.begin_run(start(points=points, refers_to=99))
    assert [run.id for run in store.runs()] == [1, 2]


@pytest.mark.parametrize(
    "table", ["run", "file", "run_file", "setting", "planned", "touch", "alarm", "ending", "session", "result"]
)
def test_no_row_of_a_store_is_changed_or_removed(
    store: MeasurementStore, start: Start, touch: Touched, table: str
) -> None:
    run = store.begin_run(start(1))
    run.commit_touch(1, touch(1))
    run.add_alarm(Alarm("1", "65001", "touched nothing", 1000, True))
    run.add_result("evaluation", b"{}")
    run.finish("complete")
    column = "sha256" if table == "file" else "run"
    before = store.execute(f"SELECT * FROM {table}")
    assert before
    for sql in (f"DELETE FROM {table}", f"UPDATE {table} SET {column} = {column}"):
        with pytest.raises(ComputationError, match="append-only"):
            store.execute(sql)
    assert store.execute(f"SELECT * FROM {table}") == before


@pytest.mark.parametrize("text", ["'; DROP TABLE touch; --", 'a"b', "Ø\u2028\U0001f600", "x" * 100_000, "%s ? :a {0}"])
def test_texts_are_values_and_never_sql(store: MeasurementStore, start: Start, touch: Touched, text: str) -> None:
    begun = start(2, control=text, program=text, operator=text, files={text: b""}, settings={text: text})
    run = store.begin_run(begun)
    run.commit_touch(1, touch(1))
    run.add_alarm(Alarm(text, text, text, 1, True, text))
    run.finish(text)
    read = store.run(run.id)
    assert (read.start, read.touches()) == (begun, {1: touch(1)})


def test_the_same_file_of_many_runs_is_kept_once(store: MeasurementStore, start: Start) -> None:
    for _ in range(3):
        store.begin_run(start(2))
    assert store.execute("SELECT count(*) FROM file") == [(3,)]  # program, set and machine


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"columns": ("run", "point", "X")}, "are not those of touches"),
        ({"points": {}}, "has no point to touch"),
        ({"points": {1: ("gear", "concave")}}, "must be member,flank,tooth,row,col"),
        ({"points": {1: ("gear", "concave", "a", "2", "4")}}, "must be whole numbers"),
    ],
)
def test_a_run_that_could_not_be_stored_is_not_begun(
    store: MeasurementStore, start: Start, changes: dict, why: str
) -> None:
    with pytest.raises(InputError, match=why):
        store.begin_run(start(**changes))
    assert store.runs() == []


def test_a_store_of_version_1_keeps_all_it_has(tmp_path: Path, touch: Touched) -> None:
    path = tmp_path / "old.db"
    with sqlite3.connect(path) as old:
        old.executescript((DATA / "store_version_1.sql").read_text("utf-8"))
    kept = {table: old.execute(f"SELECT * FROM {table}").fetchall() for table in ("run", "touch", "alarm", "ending")}
    old.close()
    with MeasurementStore.open(path) as store:
        assert store.execute("PRAGMA user_version") == [(VERSION,)]
        for table, rows in kept.items():
            assert store.execute(f"SELECT * FROM {table}") == rows
        assert store.execute("SELECT run, number, operator FROM session") == [(1, 1, "operator"), (2, 1, "operator")]
        assert store.run(1).is_complete
        resumed = store.resume_run(2)
        assert resumed.missing() == [4, 5, 6, 7, 8]
        resumed.add_result("evaluation", b"{}")
        for point in resumed.missing():
            resumed.commit_touch(point, touch(point))
        resumed.finish("complete")
        assert store.execute("PRAGMA integrity_check") == [("ok",)]
        assert store.execute("PRAGMA foreign_key_check") == []


def test_a_migration_that_fails_leaves_the_old_store_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from gearmath.control import store_schema

    path = tmp_path / "old.db"
    with sqlite3.connect(path) as old:
        old.executescript((DATA / "store_version_1.sql").read_text("utf-8"))
    old.close()
    broken = (store_schema.MIGRATIONS[0], (*store_schema.MIGRATIONS[1][:2], "CREATE TABLE run (x)"))
    monkeypatch.setattr(store_schema, "MIGRATIONS", broken)
    with pytest.raises(InputError, match="cannot be opened as a measurement store: table run already exists"):
        MeasurementStore.open(path)
    monkeypatch.undo()
    with sqlite3.connect(path) as old:
        assert old.execute("PRAGMA user_version").fetchall() == [(1,)]
        assert old.execute("SELECT count(*) FROM sqlite_master WHERE name = 'session'").fetchall() == [(0,)]
    old.close()


def test_a_store_of_a_newer_version_is_refused_and_left_alone(store: MeasurementStore) -> None:
    store.close()
    with sqlite3.connect(store.path) as newer:
        newer.execute(f"PRAGMA user_version = {VERSION + 1}")
    newer.close()
    before = store.path.read_bytes()
    with pytest.raises(InputError, match=f"version {VERSION + 1}, this gearmath knows versions up to {VERSION}"):
        MeasurementStore.open(store.path)
    assert store.path.read_bytes() == before


def test_other_files_are_refused_and_left_alone(tmp_path: Path) -> None:
    other = tmp_path / "other.db"
    with sqlite3.connect(other) as connection:
        connection.execute("CREATE TABLE mine (x)")
    connection.close()
    text = tmp_path / "text.db"
    text.write_text("run,point,member\n" * 100)
    for path, why in ((other, "but no measurement store"), (text, "file is not a database")):
        before = path.read_bytes()
        with pytest.raises(InputError, match=why):
            MeasurementStore.open(path)
        assert path.read_bytes() == before
    assert sorted(tmp_path.iterdir()) == [other, text]


def test_a_store_that_is_not_there_is_made_only_to_write_into_it(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no such measurement store"):
        MeasurementStore.open(tmp_path / "none.db", create=False)
    with pytest.raises(InputError, match="there is no folder"):
        MeasurementStore.open(tmp_path / "nowhere" / "none.db")
    assert list(tmp_path.iterdir()) == []


def test_no_name_makes_a_store_that_is_in_memory_only(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, start: Start
) -> None:
    monkeypatch.chdir(tmp_path)
    with MeasurementStore.open(Path(":memory:")) as store:
        store.begin_run(start(1))
    assert (tmp_path / ":memory:").exists()
    with MeasurementStore.open(Path(":memory:"), create=False) as store:
        assert len(store.runs()) == 1


def test_a_file_system_without_the_journal_is_refused() -> None:
    """As SQLite answers where there is no shared memory: it keeps another journal and says which."""
    connection = sqlite3.connect(":memory:", isolation_level=None)
    with pytest.raises(InputError, match=r"does not take the journal WAL \(journal_mode = memory\)"):
        prepare(connection, "runs.db")
    connection.close()


def test_a_store_says_what_it_is(store: MeasurementStore) -> None:
    """As the file format of SQLite has it: application_id big-endian at byte 68, the user version at byte 60."""
    store.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    header = store.path.read_bytes()[:100]
    assert header[68:72] == b"gmms" == APPLICATION_ID.to_bytes(4, "big")
    assert int.from_bytes(header[60:64], "big") == VERSION
    settings = [store.execute(f"PRAGMA {name}")[0][0] for name in ("journal_mode", "synchronous", "foreign_keys")]
    assert settings == ["wal", 2, 1]


def test_a_full_disk_keeps_what_was_acknowledged(store: MeasurementStore, start: Start, touch: Touched) -> None:
    run = store.begin_run(start(200))
    (pages,) = store.execute("PRAGMA page_count")[0]
    store.execute(f"PRAGMA max_page_count = {pages + 1}")
    kept = {}

    def measure() -> None:
        for point in range(1, 201):
            run.commit_touch(point, touch(point))
            kept[point] = touch(point)

    with pytest.raises(ComputationError, match=r"run 1, point \d+ cannot be kept: database or disk is full"):
        measure()
    assert kept
    store.execute("PRAGMA max_page_count = 100000")
    assert run.touches() == kept
    run.commit_touch(run.missing()[0], touch(run.missing()[0]))


def test_a_damaged_store_is_said_and_shows_no_traceback(
    store: MeasurementStore, start: Start, touch: Touched, command: Callable[..., tuple[int, str, str]]
) -> None:
    """Zeros over the first page of the touches."""
    run = store.begin_run(start(50))
    for point in range(1, 51):
        run.commit_touch(point, touch(point))
    ((size,),) = store.execute("PRAGMA page_size")
    ((page,),) = store.execute("SELECT rootpage FROM sqlite_master WHERE name = 'touch'")
    store.close()
    content = bytearray(store.path.read_bytes())
    content[(page - 1) * size : page * size] = bytes(size)
    store.path.write_bytes(content)
    for verb in (("list",), ("show", 1), ("export", 1, "-o", store.path.with_name("x.csv"))):
        status, out, err = command("runs", *verb, "--store", store.path)
        assert (status, out, err.count("\n")) == (1, "", 1)
        assert "runs.db: database disk image is malformed" in err
    assert not store.path.with_name("x.csv").exists()


def test_the_store_loads_nothing_heavy() -> None:
    code = "import sys, gearmath.control.store; print({'numpy', 'casadi', 'sympy', 'asyncua'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"
