"""The zip archive of an FMU, from entries that are compressed already: zipfile would compress the library again for every FMU.

    local header, name, stream     of every entry
    directory entry, name          of every entry, with the place of its local header
    end of directory

All numbers are little-endian (PKWARE APPNOTE 4.3). Time stamps and modes are fixed, so that the same entries give the same bytes.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from pathlib import Path

from softffd.files import replacing
from softffd.fmu.deflated import Deflated

LOCAL, DIRECTORY, END = struct.Struct("<4s5H3L2H"), struct.Struct("<4s6H3L5H2L"), struct.Struct("<4s4H2LH")
VERSION, DEFLATE = 20, 8
UNIX = 3 << 8 | VERSION
MIDNIGHT, NEW_YEAR_2020 = 0, (2020 - 1980) << 9 | 1 << 5 | 1
MODE = 0o644 << 16
LARGEST = 0xFFFFFFFF


def write_archive(path: Path, entries: Mapping[str, Deflated]) -> None:
    """Writes the entries by name, modelDescription.xml first, the others sorted. path: its folder is made where it is missing."""
    names = sorted(entries, key=lambda name: (name != "modelDescription.xml", name))
    parts: list[bytes] = []
    directory: list[bytes] = []
    place = 0
    for name in names:
        content, text = entries[name], name.encode("ascii")
        common = (0, DEFLATE, MIDNIGHT, NEW_YEAR_2020, content.crc, len(content.stream), content.size, len(text), 0)
        parts += [LOCAL.pack(b"PK\x03\x04", VERSION, *common), text, content.stream]
        directory += [DIRECTORY.pack(b"PK\x01\x02", UNIX, VERSION, *common, 0, 0, 0, MODE, place), text]
        place += LOCAL.size + len(text) + len(content.stream)
    assert place <= LARGEST, "an archive past 4 GB has another form"
    end = END.pack(b"PK\x05\x06", 0, 0, len(names), len(names), sum(map(len, directory)), place, 0)
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as stream:
        stream.writelines([*parts, *directory, end])
