"""The tables of a measurement store, how an older store becomes a newer one, and how a connection must be set."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from gearmath.errors import InputError

#: "gmms", gearmath measurement store: what tells a store from other SQLite files.
APPLICATION_ID = 0x676D6D73

_VERSION_1 = (
    """CREATE TABLE run (
        run INTEGER PRIMARY KEY AUTOINCREMENT, control TEXT NOT NULL, program TEXT NOT NULL, begun TEXT NOT NULL,
        operator TEXT NOT NULL, host TEXT NOT NULL, gearmath TEXT NOT NULL, refers_to INTEGER REFERENCES run (run)
    ) STRICT""",
    "CREATE TABLE file (sha256 TEXT PRIMARY KEY, content BLOB NOT NULL) STRICT",
    """CREATE TABLE run_file (
        run INTEGER NOT NULL REFERENCES run (run), role TEXT NOT NULL CHECK (role IN ('program', 'file')),
        name TEXT NOT NULL, sha256 TEXT NOT NULL REFERENCES file (sha256), PRIMARY KEY (run, role, name)
    ) STRICT""",
    """CREATE TABLE setting (
        run INTEGER NOT NULL REFERENCES run (run), name TEXT NOT NULL, value TEXT NOT NULL, PRIMARY KEY (run, name)
    ) STRICT""",
    """CREATE TABLE planned (
        run INTEGER NOT NULL REFERENCES run (run), point INTEGER NOT NULL, member TEXT, flank TEXT, tooth INTEGER,
        "row" INTEGER, col INTEGER, target TEXT, PRIMARY KEY (run, point), CHECK ((flank IS NULL) <> (target IS NULL))
    ) STRICT""",
    """CREATE TABLE touch (
        run INTEGER NOT NULL, point INTEGER NOT NULL, control_run INTEGER NOT NULL, X REAL NOT NULL, Y REAL NOT NULL,
        Z REAL NOT NULL, A REAL NOT NULL, B REAL NOT NULL, triggered INTEGER NOT NULL CHECK (triggered IN (0, 1)),
        taken TEXT NOT NULL, PRIMARY KEY (run, point), FOREIGN KEY (run, point) REFERENCES planned (run, point)
    ) STRICT""",
    """CREATE TABLE alarm (
        run INTEGER NOT NULL REFERENCES run (run), number INTEGER NOT NULL, at TEXT NOT NULL, key TEXT NOT NULL,
        alarm TEXT NOT NULL, text TEXT NOT NULL, severity INTEGER NOT NULL, active INTEGER NOT NULL,
        time TEXT NOT NULL, PRIMARY KEY (run, number)
    ) STRICT""",
    """CREATE TABLE ending (
        run INTEGER NOT NULL REFERENCES run (run), number INTEGER NOT NULL, at TEXT NOT NULL, outcome TEXT NOT NULL,
        PRIMARY KEY (run, number)
    ) STRICT""",
)
#: Who went on with a run, and what was made of it.
_VERSION_2 = (
    """CREATE TABLE session (
        run INTEGER NOT NULL REFERENCES run (run), number INTEGER NOT NULL, at TEXT NOT NULL, operator TEXT NOT NULL,
        host TEXT NOT NULL, gearmath TEXT NOT NULL, PRIMARY KEY (run, number)
    ) STRICT""",
    "INSERT INTO session SELECT run, 1, begun, operator, host, gearmath FROM run",
    """CREATE TABLE result (
        run INTEGER NOT NULL REFERENCES run (run), number INTEGER NOT NULL, at TEXT NOT NULL, gearmath TEXT NOT NULL,
        kind TEXT NOT NULL, content BLOB NOT NULL, PRIMARY KEY (run, number)
    ) STRICT""",
)
#: A run that is complete takes no more.
_CLOSED = """CREATE TRIGGER {table}_of_complete_run BEFORE INSERT ON {table}
    WHEN EXISTS (SELECT 1 FROM ending WHERE run = NEW.run AND outcome = 'complete')
    BEGIN SELECT RAISE (ABORT, 'the run is complete'); END"""
_KEPT = (
    "CREATE TRIGGER {table}_is_not_changed BEFORE UPDATE ON {table} BEGIN SELECT RAISE (ABORT, 'append-only'); END",
    "CREATE TRIGGER {table}_is_not_deleted BEFORE DELETE ON {table} BEGIN SELECT RAISE (ABORT, 'append-only'); END",
)


def _append_only(*tables: str) -> tuple[str, ...]:
    return tuple(trigger.format(table=table) for table in tables for trigger in _KEPT)


#: The statements that lead from each version to the next one; the first makes an empty file a store.
MIGRATIONS: tuple[tuple[str, ...], ...] = (
    (
        *_VERSION_1,
        *_append_only("run", "file", "run_file", "setting", "planned", "touch", "alarm", "ending"),
        *(_CLOSED.format(table=table) for table in ("planned", "touch", "ending")),
    ),
    (*_VERSION_2, *_append_only("session", "result"), _CLOSED.format(table="session")),
)
VERSION = len(MIGRATIONS)

#: Every commit is on the disk before it returns. fullfsync: on macOS fsync alone leaves it in the drive's cache.
SETTINGS = (
    "PRAGMA journal_mode = WAL",
    "PRAGMA synchronous = FULL",
    "PRAGMA fullfsync = ON",
    "PRAGMA checkpoint_fullfsync = ON",
    "PRAGMA foreign_keys = ON",
)


def prepare(connection: Any, path: object, settings: Iterable[str] = SETTINGS) -> None:
    """Set a connection, make an empty file a store, and bring an older store up to this version.

    ``connection`` runs SQL by ``execute`` and is in no transaction of its own (sqlite3 with isolation_level=None, or
    apsw). Raises InputError for another SQLite file and for a store of a newer version, which are left as they are.
    """
    _version(connection, path)  # before anything is written
    for setting in settings:
        connection.execute(setting).fetchall()
    ((journal,),) = connection.execute("PRAGMA journal_mode").fetchall()
    if journal != "wal":
        raise InputError(
            f"{path}: its file system does not take the journal WAL (journal_mode = {journal}): a store must lie on "
            "a disk of this computer"
        )
    if _version(connection, path) == VERSION:
        return
    connection.execute("BEGIN IMMEDIATE")
    try:
        # read again: another process may have done it meanwhile
        for statements in MIGRATIONS[_version(connection, path) :]:
            for statement in statements:
                connection.execute(statement)
        connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
        connection.execute(f"PRAGMA user_version = {VERSION}")
        connection.execute("COMMIT")
    except BaseException:
        connection.execute("ROLLBACK")
        raise


def _version(connection: Any, path: object) -> int:
    """The version of a store, 0 for an empty file. Raises InputError for what is none, and for a newer one."""
    ((application,),) = connection.execute("PRAGMA application_id").fetchall()
    ((version,),) = connection.execute("PRAGMA user_version").fetchall()
    ((tables,),) = connection.execute("SELECT count(*) FROM sqlite_master").fetchall()
    if application != APPLICATION_ID and (application or version or tables):
        raise InputError(f"{path}: is a SQLite file, but no measurement store (application_id = {application:#x})")
    if version > VERSION:
        raise InputError(
            f"{path}: is a measurement store of version {version}, this gearmath knows versions up to {VERSION}"
        )
    return version
