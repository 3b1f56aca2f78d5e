"""The zip archive of an FMU: writes it, and unpacks what a run needs."""

import re
import zlib
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo, is_zipfile

from softffd.errors import FmuError, SoftffdError
from softffd.files import replacing
from softffd.installed import host_library, loaded_library

LARGEST, MOST_TIMES = 1e9, 100  # most bytes that any FMU may unpack to; a larger FMU may unpack to this many times its own size
NEW_YEAR_2020 = (2020, 1, 1, 0, 0, 0)
UNIX, MODE = 3, 0o644 << 16
ELF = {0x3E: "x86_64", 0xB7: "aarch64"}  # processors by their numbers in ELF files


def write_archive(path: Path, entries: Mapping[str, bytes]) -> None:
    """Writes the entries by name, modelDescription.xml first, the others sorted. Time stamps and modes are fixed, so that the same
    entries give the same bytes. path: its folder is made if missing."""
    with replacing(path) as stream, ZipFile(stream, "w") as archive:
        for name in sorted(entries, key=lambda name: (name != "modelDescription.xml", name)):
            entry = ZipInfo(name, NEW_YEAR_2020)
            entry.compress_type, entry.create_system, entry.external_attr = ZIP_DEFLATED, UNIX, MODE
            archive.writestr(entry, entries[name])


def unpack(path: Path, folder: str) -> str | None:
    """Unpacks what a run reads: no documentation, no terminals, no libraries of other platforms. If the FMU contains the installed
    library, returns the path of the installed one and does not unpack the other: unpacking and loading it again would take longer than a
    thousand communication steps."""
    import fmpy

    with ZipFile(path) as archive:
        same = next((entry.filename for entry in archive.infolist() if _is_installed(entry)), None)
        require_no_bomb(archive, path.stat().st_size)
    fmpy.extract(str(path), unzipdir=folder, include=lambda name: name != same and _is_read(name))
    return str(loaded_library()._name) if same else None


def require_no_bomb(archive: ZipFile, packed: int) -> None:
    """Raises FmuError for a small file whose entries would fill the disk. zipfile writes no more of an entry than its stated size."""
    size = sum(entry.file_size for entry in archive.infolist() if _is_read(entry.filename))
    if size > max(LARGEST, MOST_TIMES * packed):
        raise FmuError(
            f"{archive.filename}: its {packed / 1e6:.3g} MB would unpack to {size / 1e9:.3g} GB; wanted at most {LARGEST / 1e9:g} GB, or "
            f"{MOST_TIMES} times the file's size where that is more"
        )


def _is_read(name: str) -> bool:
    room, _, rest = name.partition("/")
    return room not in ("documentation", "sources", "terminalsAndIcons") and (room != "binaries" or rest.partition("/")[0] in platforms())


def _is_installed(entry: ZipInfo) -> bool:
    """True if the entry is a library of this platform with name, checksum and size (in the archive's directory) of the installed one."""
    room, _, rest = entry.filename.partition("/")
    platform, _, name = rest.partition("/")
    return room == "binaries" and platform in platforms() and (name, entry.CRC, entry.file_size) == _installed()


def of_another_machine(path: str, folder: Path, identifier: str) -> str | None:
    """Returns an explanation if an FMU, unpacked into the folder, has a Linux library for another processor, which the system reports as
    missing, or libraries for other platforms only; else None."""
    own = platforms()[1]
    for file in folder.glob(f"binaries/*/{identifier}.so"):
        with file.open("rb") as stream:
            head = stream.read(20)
        processor = ELF.get(int.from_bytes(head[18:20], "little")) if head.startswith(b"\x7fELF") else None
        if processor and not own.startswith(processor):
            return f"its library {file.relative_to(folder).as_posix()} is for {processor}-linux, this machine is {own}"
    if is_zipfile(path) and not any(folder.glob(f"binaries/*/{identifier}.*")):
        with ZipFile(path) as archive:
            held = sorted({name.split("/")[1] for name in archive.namelist() if re.fullmatch("binaries/[^/]+/.+", name)})
        return f"wanted a library for {' or '.join(platforms())}, got {', '.join(held) or 'none'}"
    return None


def library_in_tuple(folder: Path, identifier: str, *, three: bool) -> str | None:
    """Returns an unpacked FMU's library in the folder of FMI 3.0, which FMI 2.0.4 has too if the machine is not an x86; None if there is
    none."""
    own = platforms()[1]
    if not three and own.startswith("x86"):  # FMI 2.0 has its own names for x86 platforms
        return None
    return next(map(str, folder.glob(f"binaries/{own}/{identifier}.*")), None)


def platforms() -> tuple[str, str]:
    """Returns the names of this machine in FMI 2.0 and in FMI 3.0."""
    import fmpy  # imports much that writing an archive does not need

    return fmpy.platform, fmpy.platform_tuple


@cache
def _installed() -> tuple[str, int, int] | None:
    """Returns name, CRC-32 and size [bytes] of the installed library; None if there is none for this machine."""
    try:
        library = host_library()
    except SoftffdError:
        return None
    content = library.read_bytes()
    return library.name, zlib.crc32(content), len(content)
