"""Names of variables and the table's rows, both ways."""

import pytest

from softffd.installed import table
from softffd.lattice import all_points
from softffd.names import Name, Part, parse_name, part_names, variable_name, variable_names, vector_names

AT_POINT, NAMED = ("force", "position", "velocity"), ("load", "plane", "pin", "probe")


def instance_of(row):
    kind = row["name"].partition(".")[0].partition("[")[0]
    return (3, 0, 12) if kind in AT_POINT else "point" if kind in NAMED else None


@pytest.mark.parametrize("row", table()["family"], ids=lambda row: row["key"])
def test_every_row_s_names_come_back_as_its_instance_and_component(row):
    instance = instance_of(row)
    first_of_that_name = next(other for other in table()["family"] if other["name"] == row["name"])
    names = vector_names(row["key"], instance)
    assert names == [row["name"].format(i=3, j=0, k=12, name="point", c=c) for c in row.get("components", "") or ("",)]
    for name, component in zip(names, row.get("components", "") or ("",), strict=True):
        assert parse_name(name) == Name(first_of_that_name["key"], instance, component)


@pytest.mark.parametrize(
    "name",
    [
        *("", ".", "time", "mass.x", "gravity", "gravity.w", "gravity.{c}", "pin.a.friction"),
        *("position", "position[0,1,2]", "position[0,1,2].w", "position[0,1].x", "position[00,1,2].x"),
        *("position[0,1,-2].x", "position[0, 1, 2].x", "position[0,1,2].x.y", "mass[0,1,2].x"),
        *("plane.a.friction.x", "plane.a.b.friction", "plane.1a.friction", "plane..friction", "plane.{name}.friction"),
    ],
)
def test_what_is_no_name_of_the_table_is_none(name):
    assert parse_name(name) is None


def test_names_go_instance_by_instance_and_component_by_component():
    assert variable_names("position", all_points((2, 2, 2)))[:7] == [
        *("position[0,0,0].x", "position[0,0,0].y", "position[0,0,0].z"),
        *("position[1,0,0].x", "position[1,0,0].y", "position[1,0,0].z", "position[0,1,0].x"),
    ]
    assert vector_names("pin_orientation", "base") == [f"pin.base.orientation.{c}" for c in "wxyz"]
    assert variable_names("plane_friction", ["a", "b"]) == ["plane.a.friction", "plane.b.friction"]
    assert variable_name("load", "push", "z") == "load.push.z"


def test_a_part_as_text_begins_the_names_of_its_variables():
    assert vector_names("plane_reaction", "ground")[0].startswith(f"{Part('plane', 'ground')}.reaction")


def test_parts_are_listed_in_the_order_of_the_family_that_has_them_all():
    inputs, fixed = ["b", "d"], ["a", "c"]
    names = [
        *variable_names("plane_point", inputs),
        *variable_names("fixed_plane_point", fixed),
        *variable_names("plane_friction", ["a", "b", "c", "d"]),
        *variable_names("pin_reaction", ["e"]),
    ]
    assert part_names("plane", names) == ["a", "b", "c", "d"] and part_names("pin", names) == ["e"]
    assert part_names("load", names) == []


def test_parts_of_which_only_some_are_inputs_keep_the_order_of_the_scene():
    names = [*variable_names("pin_position", ["b"]), *variable_names("pin_reaction", ["a", "b", "c"])]
    assert part_names("pin", names) == ["a", "b", "c"]
