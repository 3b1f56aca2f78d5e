"""The messages about a faulty scene, such as `material.stiffness: wanted >= 0 N/m, got -5`.

A path in the file is a tuple such as ("plane", 1, "normal"), written plane[1].normal; positions count from 0.
"""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from softffd.scene.section import SIGNS
from softffd.spelling import did_you_mean, nearest_of

KeyPath = tuple[str | int, ...]

KINDS = {
    "float_type": "a number",
    "finite_number": "a finite number",
    "int_type": "a whole number",
    "bool_type": "true or false",
    "string_type": "text in quotes",
}


@dataclass(frozen=True)
class Fault:
    """One problem of a scene and its place in the file."""

    path: KeyPath
    text: str
    meant: KeyPath | None = None  # for an unknown key: path of the missing key that was probably meant

    def __str__(self) -> str:
        return f"{path_text(self.path)}: {self.text}" if self.path else self.text


def refused(path: KeyPath, wanted: str, got: Any, more: str = "") -> Fault:
    """Returns the fault of a key with an unsuitable value. got: the value, printed as in the file. more: text that follows the value."""
    return Fault(path, f"wanted {wanted}, got {f'{got:g}' if isinstance(got, float) else toml_text(got)}{more}")


def faults_of(error: ValidationError, model: type[BaseModel]) -> list[Fault]:
    """Returns the problems that pydantic found in a document for `model`, with messages in the wording of this package."""
    entries = [(entry, _without_tags(entry["loc"], spare_last=entry["type"] == "extra_forbidden")) for entry in error.errors()]
    missing = {path for entry, path in entries if entry["type"] == "missing"}
    misspelt: set[KeyPath] = set()
    found = []
    for entry, path in entries:
        if entry["type"] == "extra_forbidden":
            fault = _unknown_key(path, model, missing)
            misspelt |= {fault.meant} if fault.meant else set()
        else:
            field, got = _field_at(model, path), "nothing" if entry["type"] == "missing" else toml_text(entry["input"])
            fault = Fault(path, f"wanted {_wanted(entry, field, path)}, got {got}{_nearest(entry, field)}")
        found.append(fault)
    return [fault for fault in found if fault.path not in misspelt]


def in_file_order(faults: list[Fault], document: Mapping[Any, Any]) -> list[Fault]:
    """Returns the faults sorted by section in the order of the file, then by position in a list of tables, then as found."""
    sections = [*map(str, document), *(fault.path[0] for fault in faults)]

    def place(fault: Fault) -> tuple[int, int]:
        position = fault.path[1] if len(fault.path) > 1 else 0
        return sections.index(fault.path[0]), position if isinstance(position, int) else 0

    return sorted(faults, key=place)


def _without_tags(location: tuple[str | int, ...], *, spare_last: bool) -> KeyPath:
    """Returns pydantic's location without tags of unions (`<number>`). spare_last: keeps the last part, a key that may look like a tag."""
    last = len(location) - 1 if spare_last else None
    return tuple(part for n, part in enumerate(location) if n == last or not str(part).startswith("<"))


def path_text(path: KeyPath) -> str:
    """Returns the path as text: plane[1].normal for ("plane", 1, "normal"). Keys that need quotes in TOML are quoted."""
    text = ""
    for part in path:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            bare = re.fullmatch(r"[A-Za-z0-9_-]+", part)
            text += ("." if text else "") + (part if bare else toml_text(part))
    return text


def toml_text(value: Any) -> str:
    """Returns a value as one would write it in the file, cut to 70 characters."""
    if isinstance(value, bool | str):
        text = json.dumps(value, ensure_ascii=False)
    elif isinstance(value, list | tuple):
        text = f"[{', '.join(toml_text(entry) for entry in value)}]"
    elif isinstance(value, dict):
        text = f"{{ {', '.join(f'{key} = {toml_text(entry)}' for key, entry in value.items())} }}"
    elif isinstance(value, int) and value.bit_length() > 10_000:
        text = hex(value)  # Python refuses to write decimal numbers of so many digits
    else:
        text = str(value)
    return text if len(text) <= 70 else text[:67] + "..."


def _field_at(model: type[BaseModel], path: KeyPath) -> FieldInfo | None:
    """Returns the field that the last key of `path` names; None if there is no such key."""
    field: FieldInfo | None = None
    table: type[BaseModel] | None = model
    for key in (part for part in path if isinstance(part, str)):
        field = table.model_fields.get(key) if table else None
        table = table_in(field.annotation) if field else None
    return field


def table_in(annotation: Any) -> type[BaseModel] | None:
    """Returns the section class in the type of a key, alone or inside a list or union; None if there is none."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((table for part in get_args(annotation) if (table := table_in(part))), None)


def _unknown_key(path: KeyPath, model: type[BaseModel], missing: set[KeyPath]) -> Fault:
    if nearest := nearest_of(str(path[-1]), _keys_at(model, path[:-1])):
        meant = (*path[:-1], nearest)
        return Fault(path, f"unknown key{did_you_mean(nearest)}", meant if meant in missing else None)
    several = {name: get_origin(field.annotation) is tuple for name, field in model.model_fields.items()}
    homes = [f"[[{name}]]" if several[name] else f"[{name}]" for name in several if path[-1] in _keys_at(model, (name,))]
    if homes:
        return Fault(path, f"unknown key here; it belongs in {' or '.join(homes)}")
    return Fault(path, f"unknown key, wanted {either(_keys_at(model, path[:-1]))}")


def _keys_at(model: type[BaseModel], path: KeyPath) -> list[str]:
    """Returns the keys of the table at `path`; an empty list if there is no table."""
    field = _field_at(model, path)
    table = table_in(field.annotation) if field else model
    return list(table.model_fields) if table else []


def _wanted(entry: Mapping[str, Any], field: FieldInfo | None, path: KeyPath) -> str:
    kind, context = entry["type"], entry.get("ctx", {})
    if kind == "missing" and field:
        return field.description or "a value"
    if kind == "literal_error" and field:
        return either(_words(field.annotation))
    if kind == "tuple_type":  # single and double brackets are easily confused
        return f"tables, each under a head [[{path_text(path)}]] in double brackets"
    if kind in ("model_type", "model_attributes_type"):
        return f"one table under the head [{path[0]}] in single brackets" if len(path) == 1 else "a table"
    extra = field.json_schema_extra if field else None
    unit = str(extra.get("unit", "")).replace("1", "") if isinstance(extra, dict) else ""
    for bound in SIGNS.keys() & context.keys():
        return f"{SIGNS[bound]} {context[bound]:g} {unit}".rstrip()
    return KINDS.get(kind, entry["msg"]) + (f" ({unit})" if unit else "")


def _words(annotation: Any) -> list[str]:
    if isinstance(annotation, str):
        return [annotation]
    return [word for part in get_args(annotation) for word in _words(part)]


def either(words: Sequence[str]) -> str:
    """Returns the words as text: "a", "b" or "c"."""
    quoted = [f'"{word}"' for word in words]
    return " or ".join([", ".join(quoted[:-1]), quoted[-1]] if len(quoted) > 1 else quoted)


def _nearest(entry: Mapping[str, Any], field: FieldInfo | None) -> str:
    if entry["type"] == "literal_error" and field and isinstance(entry["input"], str):
        return did_you_mean(nearest_of(entry["input"], _words(field.annotation)))
    return did_you_mean(entry.get("ctx", {}).get("nearest"))
