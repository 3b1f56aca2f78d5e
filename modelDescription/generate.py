"""Writes the C++ view of variables.toml: python generate.py variables.toml OUTPUT.hpp (run by CMake)."""

import sys
import tomllib
from pathlib import Path

HEAD = """// Generated from modelDescription/variables.toml; change that file, not this one.
#pragma once
#include <cstdint>
#include <limits>
#include <string_view>

namespace softffd::fmi {

enum class Type : std::uint8_t { Real, Integer };
enum class Causality : std::uint8_t { input, parameter, output };
enum class Variability : std::uint8_t { continuous, discrete, tunable, fixed };
"""

METHOD = """
/// The methods by the numbers that stand for them, from 1 on.
inline constexpr std::string_view methods[] = {
"""

INFO = """
/// One row of the table. Name placeholders: {i} {j} {k} {name} {obstacle} {body} {c}.
struct FamilyInfo {
  Family family;
  std::string_view name;
  Part part;
  std::string_view pose;        ///< vector of a plane's or pin's pose and motion; empty: none
  std::string_view components;  ///< one letter each; empty: a scalar
  Type type;
  Causality causality;
  Variability variability;
  std::string_view unit;
  double min;    ///< least value allowed
  double above;  ///< exclusive lower bound
  double max;    ///< greatest value allowed
  bool material;  ///< masses, springs or damping depend on it
};

inline constexpr double no_bound = -std::numeric_limits<double>::infinity();
inline constexpr double no_limit = -no_bound;
"""


def enum(name: str, rows: list[tuple[str, int]]) -> str:
    return f"enum class {name} : std::uint8_t {{ " + ", ".join(f"{key} = {value}" for key, value in rows) + " };\n"


def bound(family: dict, key: str, absent: str = "no_bound") -> str:
    return repr(float(family[key])) if isinstance(family.get(key), int | float) else absent


def row(family: dict) -> str:
    fields = [
        f"Family::{family['key']}", f'"{family["name"]}"', f"Part::{family['part']}",
        f'"{family.get("pose", "")}"', f'"{family.get("components", "")}"',
        f"Type::{family.get('type', 'Real')}", f"Causality::{family['causality']}", f"Variability::{family['variability']}",
        f'"{family.get("unit", "")}"', bound(family, "min"), bound(family, "above"), bound(family, "max", "no_limit"),
        "true" if family.get("material") else "false",
    ]  # fmt: skip
    return "    {" + ", ".join(fields) + "},\n"


def header(table: dict) -> str:
    families = table["family"]
    ids = [family["id"] for family in families]
    if len(set(ids)) != len(ids) or not all(0 < i < 128 for i in ids):
        raise SystemExit("variables.toml: family ids must be unique and within 1..127")
    parts = list(dict.fromkeys(family["part"] for family in families))
    text = HEAD + enum("Family", [(f["key"], f["id"]) for f in families]) + enum("Part", [(p, n) for n, p in enumerate(parts)])
    text += enum("MethodValue", [(("automatic" if m["key"] == "auto" else m["key"]), m["value"]) for m in table["method"]])
    if [m["value"] for m in table["method"]] != list(range(1, len(table["method"]) + 1)):
        raise SystemExit("variables.toml: methods must be numbered from 1, in their order")
    text += METHOD + "".join(f'    "{m["key"]}",\n' for m in table["method"]) + "};\n"
    text += f"inline constexpr int method_count = {len(table['method'])};\n"
    for category in table["log_category"]:
        text += f'inline constexpr const char* log_{category["key"]} = "{category["name"]}";\n'
    names = ", ".join(f'"{category["name"]}"' for category in table["log_category"])
    text += f"inline constexpr const char* log_categories[] = {{{names}}};\n"
    text += INFO + "inline constexpr FamilyInfo families[] = {\n" + "".join(map(row, families)) + "};\n"
    return text + "\n}  // namespace softffd::fmi\n"


if __name__ == "__main__":
    source, target = map(Path, sys.argv[1:])
    target.write_text(header(tomllib.loads(source.read_text())))
