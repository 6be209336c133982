"""What a file's name ends in."""

from __future__ import annotations

import pytest

from twin.ending import ending_of

ENDINGS = {
    "a.csv": ".csv",
    "A.CSV": ".csv",
    "a.b.json": ".json",
    "a.csv.gz": ".csv.gz",
    "a.CSV.GZ": ".csv.gz",
    "a.tar.gz": ".tar.gz",
    ".json": ".json",
    ".csv.gz": ".csv.gz",
    ".gz": ".gz",
    "a.gz": ".gz",
    "a.": ".",
    "a": "",
    "": "",
    "folder.d/a": "",
    "folder.d/.H": ".h",
}


@pytest.mark.parametrize("name", ENDINGS)
def test_ending(name: str) -> None:
    assert ending_of(name) == ENDINGS[name]
