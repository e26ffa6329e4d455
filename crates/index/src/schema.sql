CREATE TABLE meta (            -- what holds for the whole index
    name  TEXT PRIMARY KEY,    -- options, shapes, unfinished, change, writers, notes
    value TEXT NOT NULL
) STRICT, WITHOUT ROWID;
CREATE TABLE shapes (
    id       TEXT PRIMARY KEY, -- the name of the shape
    label    TEXT NOT NULL,    -- its class; empty if it has none
    path     TEXT NOT NULL,    -- its mesh, as seen from the folder of the index
    content  TEXT NOT NULL,    -- SHA-256 of the files of the mesh
    vertices INTEGER NOT NULL,
    faces    INTEGER NOT NULL,
    area     REAL NOT NULL,    -- in squared mesh units
    diameter REAL NOT NULL,    -- the largest distance on the surface from a sample, in mesh units
    dropped_area_share REAL NOT NULL,
    components INTEGER NOT NULL,
    shortcuts  INTEGER NOT NULL,
    longest_boundary REAL NOT NULL,
    vectors    INTEGER NOT NULL, -- its rows in vectors and components
    checksum   INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
CREATE TABLE fused (           -- the vectors that are searched, apart so that a scan reads nothing else
    id       TEXT PRIMARY KEY,
    vector   BLOB NOT NULL,
    checksum INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
CREATE TABLE components (      -- the fused vectors of further components of a mesh
    id       TEXT NOT NULL,
    place    INTEGER NOT NULL,
    vector   BLOB NOT NULL,
    checksum INTEGER NOT NULL,
    PRIMARY KEY (id, place)
) STRICT, WITHOUT ROWID;
CREATE TABLE vectors (         -- form (x, y, z and weight of each point), disc_areas, and a signature each
    id       TEXT NOT NULL,
    name     TEXT NOT NULL,
    vector   BLOB NOT NULL,
    checksum INTEGER NOT NULL,
    PRIMARY KEY (id, name)
) STRICT;
