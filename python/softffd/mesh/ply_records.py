"""What follows the header of a PLY file, text or binary: the records of its elements, held to what the header says."""

from itertools import accumulate
from typing import NamedTuple

import numpy as np

TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4",
    "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
    "int64": "i8", "uint64": "u8", "float": "f4", "double": "f8", "float32": "f4", "float64": "f8",
}  # fmt: skip
_BYTES = {type_: int(type_[1]) for type_ in TYPES.values()}
_TOO_SHORT = "the file ends within the data that the header promises"


class Property(NamedTuple):
    name: str
    type: str
    count_type: str | None


class Element(NamedTuple):
    name: str
    records: int
    properties: list[Property]


class Lists(NamedTuple):
    """A list property of all records: `counts` (N,) and the `values` of all of them one after another."""

    counts: np.ndarray
    values: np.ndarray


class TextBody:
    def __init__(self, body: bytes):
        self.words, self.at = body.split(), 0

    def room(self, _properties: list[Property]) -> int:
        """Records that could follow at the most: one word for each property."""
        return (len(self.words) - self.at) // len(_properties)

    def take(self, _type: str, count: int) -> np.ndarray:
        """The next `count` numbers of one type."""
        words = self.words[self.at : self.at + count]
        if len(words) < count:
            raise ValueError(_TOO_SHORT)
        self.at += count
        try:
            return np.array([float(word) for word in words])
        except ValueError:
            raise ValueError("the data hold something that is not a number") from None

    def take_table(self, types: list[str], counts: list[int], records: int) -> list[np.ndarray]:
        """The next `records` records, each of len(counts) groups of numbers; arrays (records, count)."""
        table = self.take(types[0], records * sum(counts)).reshape(records, -1)
        return np.split(table, list(accumulate(counts))[:-1], axis=1)

    def rest(self) -> str:
        """What follows after the records, in words."""
        if self.at < len(self.words):
            raise ValueError(f"{len(self.words) - self.at} numbers follow after all that the header describes")
        return ""


class BinaryBody:
    def __init__(self, body: bytes, order: str):
        self.body, self.order, self.at = body, order, 0

    def room(self, properties: list[Property]) -> int:
        """Records that could follow at the most: every list empty."""
        return (len(self.body) - self.at) // sum(_BYTES[p.count_type or p.type] for p in properties)

    def take(self, type_: str, count: int) -> np.ndarray:
        """As for a text."""
        start = self._advance(_BYTES[type_] * count)
        return np.frombuffer(self.body, self.order + type_, count=count, offset=start)

    def take_table(self, types: list[str], counts: list[int], records: int) -> list[np.ndarray]:
        """As for a text."""
        groups = list(zip(types, counts, strict=True))
        start = self._advance(records * sum(_BYTES[type_] * count for type_, count in groups))
        record = np.dtype([(f"f{n}", self.order + type_, (count,)) for n, (type_, count) in enumerate(groups)])
        table = np.frombuffer(self.body, record, count=records, offset=start)
        return [table[f"f{n}"] for n in range(len(groups))]

    def _advance(self, size: int) -> int:
        if size > len(self.body) - self.at:
            raise ValueError(_TOO_SHORT)
        self.at += size
        return self.at - size

    def rest(self) -> str:
        """As for a text, where the numbers may have lost their count; bytes are padding."""
        rest = len(self.body) - self.at
        return f"{rest} bytes that follow after all that the header describes" if rest else ""


Body = TextBody | BinaryBody


def read_element(reader: Body, element: Element) -> dict[str, np.ndarray | Lists]:
    """The element's properties by name: (N,) for a number, Lists for a list."""
    if element.records == 0 or not element.properties:
        return {}
    if element.records > reader.room(element.properties):
        raise ValueError(f"the header promises {element.records} records '{element.name}', more than the file has room for")
    if all(p.count_type is None for p in element.properties):
        types = [p.type for p in element.properties]
        columns = reader.take_table(types, [1] * len(types), element.records)
        return {p.name: column[:, 0] for p, column in zip(element.properties, columns, strict=True)}
    return _read_alike(reader, element) or _read_one_by_one(reader, element)


def _read_alike(reader: Body, element: Element) -> dict[str, np.ndarray | Lists] | None:
    """All records at once if their lists are as long as the first one's; else None, with nothing consumed."""
    start = reader.at
    sizes = [len(values) for values in _read_record(reader, element)]
    reader.at = start
    types, counts = [], []
    for p, size in zip(element.properties, sizes, strict=True):
        types += [p.type] if p.count_type is None else [p.count_type, p.type]
        counts += [1] if p.count_type is None else [1, size]
    try:
        columns = iter(reader.take_table(types, counts, element.records))
    except ValueError:
        reader.at = start
        return None
    found: dict[str, np.ndarray | Lists] = {}
    for p, size in zip(element.properties, sizes, strict=True):
        lengths = next(columns)[:, 0]
        if p.count_type is None:
            found[p.name] = lengths
        elif (lengths == size).all():
            found[p.name] = Lists(lengths.astype(np.int64), next(columns).reshape(-1))
        else:
            reader.at = start
            return None
    return found


def _read_one_by_one(reader: Body, element: Element) -> dict[str, np.ndarray | Lists]:
    found: list[list[np.ndarray]] = [[] for _ in element.properties]
    for _ in range(element.records):
        for values, record in zip(found, _read_record(reader, element), strict=True):
            values.append(record)
    columns: dict[str, np.ndarray | Lists] = {}
    for p, values in zip(element.properties, found, strict=True):
        joined = np.concatenate(values)
        columns[p.name] = joined if p.count_type is None else Lists(np.array([len(v) for v in values]), joined)
    return columns


def _read_record(reader: Body, element: Element) -> list[np.ndarray]:
    values = []
    for p in element.properties:
        length = 1.0 if p.count_type is None else float(reader.take(p.count_type, 1)[0])
        if not (length >= 0 and length.is_integer()):
            raise ValueError(f"a list '{p.name}' of the element '{element.name}' has the length {length:g}")
        values.append(reader.take(p.type, int(length)))
    return values
