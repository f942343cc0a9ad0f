PRAGMA application_id = 1735224691;
PRAGMA user_version = 1;
BEGIN TRANSACTION;
CREATE TABLE alarm (
        run INTEGER NOT NULL REFERENCES run (run), number INTEGER NOT NULL, at TEXT NOT NULL, key TEXT NOT NULL,
        alarm TEXT NOT NULL, text TEXT NOT NULL, severity INTEGER NOT NULL, active INTEGER NOT NULL,
        time TEXT NOT NULL, PRIMARY KEY (run, number)
    ) STRICT;
INSERT INTO "alarm" VALUES(2,1,'2026-11-27T13:29:35.224Z','65001#1','65001','touched nothing',1000,1,'2026-11-27T13:30:00Z');
CREATE TABLE ending (
        run INTEGER NOT NULL REFERENCES run (run), number INTEGER NOT NULL, at TEXT NOT NULL, outcome TEXT NOT NULL,
        PRIMARY KEY (run, number)
    ) STRICT;
INSERT INTO "ending" VALUES(1,1,'2026-11-27T13:29:35.194Z','complete');
INSERT INTO "ending" VALUES(2,1,'2026-11-27T13:29:35.229Z','alarm 65001: touched nothing');
CREATE TABLE file (sha256 TEXT PRIMARY KEY, content BLOB NOT NULL) STRICT;
INSERT INTO "file" VALUES('274d1ca7641dd1efe9b11a151c239a0038f432b195df3d0119d837068b20145b',X'3B2050524F42452E4D50460A4D33300A');
INSERT INTO "file" VALUES('2c2f1e4b9f1f1dfa40d6a0baa082f54adca5d4fba6e7ac7caf4b3ae13f87a3ff',X'7469746C65203D20226F6C64220A');
INSERT INTO "file" VALUES('63a04304fe9b0b0df87ce9f2ebfab945f6bf038b2e6bdc12e6b5ecfd62450354',X'6E616D65203D20226F6C64220A');
CREATE TABLE planned (
        run INTEGER NOT NULL REFERENCES run (run), point INTEGER NOT NULL, member TEXT, flank TEXT, tooth INTEGER,
        "row" INTEGER, col INTEGER, target TEXT, PRIMARY KEY (run, point), CHECK ((flank IS NULL) <> (target IS NULL))
    ) STRICT;
INSERT INTO "planned" VALUES(1,1,'gear','concave',0,2,4,NULL);
INSERT INTO "planned" VALUES(1,2,'gear','convex',0,2,4,NULL);
INSERT INTO "planned" VALUES(1,3,'gear','concave',1,2,4,NULL);
INSERT INTO "planned" VALUES(1,4,'gear','convex',1,2,4,NULL);
INSERT INTO "planned" VALUES(1,5,'gear','concave',2,2,4,NULL);
INSERT INTO "planned" VALUES(1,6,'gear','convex',2,2,4,NULL);
INSERT INTO "planned" VALUES(1,7,'gear','concave',3,2,4,NULL);
INSERT INTO "planned" VALUES(1,8,'gear','convex',3,2,4,NULL);
INSERT INTO "planned" VALUES(2,1,'gear','concave',0,2,4,NULL);
INSERT INTO "planned" VALUES(2,2,'gear','convex',0,2,4,NULL);
INSERT INTO "planned" VALUES(2,3,'gear','concave',1,2,4,NULL);
INSERT INTO "planned" VALUES(2,4,'gear','convex',1,2,4,NULL);
INSERT INTO "planned" VALUES(2,5,'gear','concave',2,2,4,NULL);
INSERT INTO "planned" VALUES(2,6,'gear','convex',2,2,4,NULL);
INSERT INTO "planned" VALUES(2,7,'gear','concave',3,2,4,NULL);
INSERT INTO "planned" VALUES(2,8,'gear','convex',3,2,4,NULL);
CREATE TABLE run (
        run INTEGER PRIMARY KEY AUTOINCREMENT, control TEXT NOT NULL, program TEXT NOT NULL, begun TEXT NOT NULL,
        operator TEXT NOT NULL, host TEXT NOT NULL, gearmath TEXT NOT NULL, refers_to INTEGER REFERENCES run (run)
    ) STRICT;
INSERT INTO "run" VALUES(1,'simulated control','PROBE.MPF','2026-11-27T13:29:35.127Z','operator','vm','0.1.0',NULL);
INSERT INTO "run" VALUES(2,'simulated control','PROBE.MPF','2026-11-27T13:29:35.201Z','operator','vm','0.1.0',NULL);
CREATE TABLE run_file (
        run INTEGER NOT NULL REFERENCES run (run), role TEXT NOT NULL CHECK (role IN ('program', 'file')),
        name TEXT NOT NULL, sha256 TEXT NOT NULL REFERENCES file (sha256), PRIMARY KEY (run, role, name)
    ) STRICT;
INSERT INTO "run_file" VALUES(1,'program','PROBE.MPF','274d1ca7641dd1efe9b11a151c239a0038f432b195df3d0119d837068b20145b');
INSERT INTO "run_file" VALUES(1,'file','set.toml','2c2f1e4b9f1f1dfa40d6a0baa082f54adca5d4fba6e7ac7caf4b3ae13f87a3ff');
INSERT INTO "run_file" VALUES(1,'file','machine.toml','63a04304fe9b0b0df87ce9f2ebfab945f6bf038b2e6bdc12e6b5ecfd62450354');
INSERT INTO "run_file" VALUES(2,'program','PROBE.MPF','274d1ca7641dd1efe9b11a151c239a0038f432b195df3d0119d837068b20145b');
INSERT INTO "run_file" VALUES(2,'file','set.toml','2c2f1e4b9f1f1dfa40d6a0baa082f54adca5d4fba6e7ac7caf4b3ae13f87a3ff');
INSERT INTO "run_file" VALUES(2,'file','machine.toml','63a04304fe9b0b0df87ce9f2ebfab945f6bf038b2e6bdc12e6b5ecfd62450354');
CREATE TABLE setting (
        run INTEGER NOT NULL REFERENCES run (run), name TEXT NOT NULL, value TEXT NOT NULL, PRIMARY KEY (run, name)
    ) STRICT;
INSERT INTO "setting" VALUES(1,'repeat','1');
INSERT INTO "setting" VALUES(2,'repeat','1');
CREATE TABLE touch (
        run INTEGER NOT NULL, point INTEGER NOT NULL, control_run INTEGER NOT NULL, X REAL NOT NULL, Y REAL NOT NULL,
        Z REAL NOT NULL, A REAL NOT NULL, B REAL NOT NULL, triggered INTEGER NOT NULL CHECK (triggered IN (0, 1)),
        taken TEXT NOT NULL, PRIMARY KEY (run, point), FOREIGN KEY (run, point) REFERENCES planned (run, point)
    ) STRICT;
INSERT INTO "touch" VALUES(1,1,1,102.234567,-12.345678,150.000123,12.0,45.0,1,'2026-11-27T13:29:35.138Z');
INSERT INTO "touch" VALUES(1,2,1,103.234567,-12.345678,150.000123,24.0,45.0,1,'2026-11-27T13:29:35.150Z');
INSERT INTO "touch" VALUES(1,3,1,104.234567,-12.345678,150.000123,36.0,45.0,1,'2026-11-27T13:29:35.158Z');
INSERT INTO "touch" VALUES(1,4,1,105.234567,-12.345678,150.000123,48.0,45.0,1,'2026-11-27T13:29:35.158Z');
INSERT INTO "touch" VALUES(1,5,1,106.234567,-12.345678,150.000123,60.0,45.0,1,'2026-11-27T13:29:35.170Z');
INSERT INTO "touch" VALUES(1,6,1,107.234567,-12.345678,150.000123,72.0,45.0,1,'2026-11-27T13:29:35.174Z');
INSERT INTO "touch" VALUES(1,7,1,108.234567,-12.345678,150.000123,84.0,45.0,1,'2026-11-27T13:29:35.181Z');
INSERT INTO "touch" VALUES(1,8,1,109.234567,-12.345678,150.000123,96.0,45.0,1,'2026-11-27T13:29:35.184Z');
INSERT INTO "touch" VALUES(2,1,2,102.234567,-12.345678,150.000123,12.0,45.0,1,'2026-11-27T13:29:35.205Z');
INSERT INTO "touch" VALUES(2,2,2,103.234567,-12.345678,150.000123,24.0,45.0,1,'2026-11-27T13:29:35.214Z');
INSERT INTO "touch" VALUES(2,3,2,104.234567,-12.345678,150.000123,36.0,45.0,1,'2026-11-27T13:29:35.216Z');
CREATE TRIGGER run_is_not_changed BEFORE UPDATE ON run BEGIN SELECT RAISE (ABORT, 'append-only'); END;
CREATE TRIGGER run_is_not_deleted BEFORE DELETE ON run BEGIN SELECT RAISE (ABORT, 'append-only'); END;
CREATE TRIGGER file_is_not_changed BEFORE UPDATE ON file BEGIN SELECT RAISE (ABORT, 'append-only'); END;
CREATE TRIGGER file_is_not_deleted BEFORE DELETE ON file BEGIN SELECT RAISE (ABORT, 'append-only'); END;
CREATE TRIGGER run_file_is_not_changed BEFORE UPDATE ON run_file BEGIN SELECT RAISE (ABORT, 'append-only'); END;
CREATE TRIGGER run_file_is_not_deleted BEFORE DELETE ON run_file BEGIN SELECT RAISE (ABORT, 'append-only'); END;
CREATE TRIGGER setting_is_not_changed BEFORE UPDATE ON setting BEGIN SELECT RAISE (ABORT, 'append-only'); END;
CREATE TRIGGER setting_is_not_deleted BEFORE DELETE ON setting BEGIN SELECT RAISE (ABORT, 'append-only'); END;
CREATE TRIGGER planned_is_not_changed BEFORE UPDATE ON planned BEGIN SELECT RAISE (ABORT, 'append-only'); END;
CREATE TRIGGER planned_is_not_deleted BEFORE DELETE ON planned BEGIN SELECT RAISE (ABORT, 'append-only'); END;
CREATE TRIGGER touch_is_not_changed BEFORE UPDATE ON touch BEGIN SELECT RAISE (ABORT, 'append-only'); END;
CREATE TRIGGER touch_is_not_deleted BEFORE DELETE ON touch BEGIN SELECT RAISE (ABORT, 'append-only'); END;
CREATE TRIGGER alarm_is_not_changed BEFORE UPDATE ON alarm BEGIN SELECT RAISE (ABORT, 'append-only'); END;
CREATE TRIGGER alarm_is_not_deleted BEFORE DELETE ON alarm BEGIN SELECT RAISE (ABORT, 'append-only'); END;
CREATE TRIGGER ending_is_not_changed BEFORE UPDATE ON ending BEGIN SELECT RAISE (ABORT, 'append-only'); END;
CREATE TRIGGER ending_is_not_deleted BEFORE DELETE ON ending BEGIN SELECT RAISE (ABORT, 'append-only'); END;
CREATE TRIGGER planned_of_complete_run BEFORE INSERT ON planned
    WHEN EXISTS (SELECT 1 FROM ending WHERE run = NEW.run AND outcome = 'complete')
    BEGIN SELECT RAISE (ABORT, 'the run is complete'); END;
CREATE TRIGGER touch_of_complete_run BEFORE INSERT ON touch
    WHEN EXISTS (SELECT 1 FROM ending WHERE run = NEW.run AND outcome = 'complete')
    BEGIN SELECT RAISE (ABORT, 'the run is complete'); END;
CREATE TRIGGER ending_of_complete_run BEFORE INSERT ON ending
    WHEN EXISTS (SELECT 1 FROM ending WHERE run = NEW.run AND outcome = 'complete')
    BEGIN SELECT RAISE (ABORT, 'the run is complete'); END;
DELETE FROM "sqlite_sequence";
INSERT INTO "sqlite_sequence" VALUES('run',2);
COMMIT;
