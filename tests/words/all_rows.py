# SPDX-License-Identifier: Apache-2.0
"""All rows, and Mitsuba's numbers for them as mitsuba.json keeps them."""
import hashlib
import json
import pathlib

import rows_cameras
import rows_files
import rows_more
import rows_numbers
import rows_pixels
import rows_shapes
import rows_tangents

ROWS = [*rows_pixels.ROWS, *rows_shapes.ROWS, *rows_numbers.ROWS, *rows_tangents.ROWS, *rows_files.ROWS, *rows_more.ROWS,
        *rows_cameras.ROWS]
STORED = pathlib.Path(__file__).resolve().parent / "mitsuba.json"


BY_WORD = {row.word: row for row in ROWS}
assert len(BY_WORD) == len(ROWS), "two rows of the same word"


def key(row):
    """A row's numbers are of its scene and files: a changed scene has none."""
    h = hashlib.sha256(row.scene.encode())
    for name, data in sorted(row.files.items()):
        h.update(name.encode() + data)
    return f"{row.word} #{h.hexdigest()[:8]}"


def load():
    return json.loads(STORED.read_text()) if STORED.exists() else {}


def expected(row, stored):
    """What ours should show, if numbers tell it."""
    if row.error or (row.why and not row.like):
        return None
    entry = stored.get(key(BY_WORD[row.like] if row.like else row), {})
    return entry.get("numbers", [])


def store(found):
    def entry(v):
        if "error" in v:
            return json.dumps({"error": "refused"})
        return json.dumps({"numbers": [[float(f"{m:.6g}"), float(f"{e:.2g}")] for m, e in v["numbers"]]})

    lines = [f"{json.dumps(k)}: {entry(v)}" for k, v in found.items()]
    STORED.write_text("{\n" + ",\n".join(lines) + "\n}\n")
