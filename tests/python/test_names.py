"""Names of variables and the table's rows, both ways."""

import re

import pytest

from softffd.installed import table
from softffd.lattice import all_points
from softffd.names import (
    OBSTACLES,
    ByName,
    Cell,
    Name,
    Part,
    flat_form,
    mistaken,
    other_form,
    parse_name,
    part_names,
    parts_of,
    structured,
    variable_name,
    variable_names,
    vector_names,
)

AT_POINT, NAMED = ("force", "position", "velocity"), ("load", "pin", "probe", "sensor")


def instance_of(row):
    kind = row["name"].partition(".")[0].partition("[")[0]
    kind = "sphere" if kind in ("{obstacle}", "{body}") else kind
    if "[{i},{j}]" in row["name"]:
        return Cell("point", 3, 0)
    return (3, 0, 12) if kind in AT_POINT else Part(kind, "point") if kind in ("sphere", *NAMED) else None


@pytest.mark.parametrize("row", table()["family"], ids=lambda row: row["key"])
def test_every_row_s_names_come_back_as_its_instance_and_component(row):
    instance = instance_of(row)
    of_obstacle = row["name"].replace("{body}", "{obstacle}")
    first_of_that_name = next(other for other in table()["family"] if other["name"] in (of_obstacle, row["name"]))
    names = vector_names(row["key"], instance)
    assert names == [
        row["name"].format(i=3, j=0, k=12, name="point", obstacle="sphere.point", body="sphere.point", c=c)
        for c in row.get("components", "") or ("",)
    ]
    for name, component in zip(names, row.get("components", "") or ("",), strict=True):
        assert parse_name(name) == Name(first_of_that_name["key"], instance, component)


@pytest.mark.parametrize(
    "name",
    [
        *("", ".", "time", "mass.x", "gravity", "gravity.w", "gravity.{c}", "pin.a.friction"),
        *("position", "position[0,1,2]", "position[0,1,2].w", "position[0,1].x", "position[00,1,2].x"),
        *("position[0,1,-2].x", "position[0, 1, 2].x", "position[0,1,2].x.y", "mass[0,1,2].x"),
        *("position_0_1_2", "position_0_1_x", "position_0_1_2_3_x", "position_00_1_2_x", "mass_0_1_2_x", "position_0,1,2_x"),
        *("position[0_1_2].x", "position_0_1_2.x", "position_0_1_2_w", "position_0_1_2_x_y", "position__0_1_2_x", "plane_a.point.x"),
        *("plane_point_x", "plane__point", "plane_1a_point_x", "gravity_w", "time_x", "cone_a_point_x"),
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
    for part in (Part("plane", "ground"), Part("sphere", "ball"), Part("cylinder", "log"), Part("box", "table")):
        assert vector_names("plane_reaction", part) == [f"{part}.reaction.{c}" for c in "xyz"]
        assert parse_name(f"{part}.contacts") == Name("plane_contacts", part, "")
    assert vector_names("plane_reaction", "ground") == vector_names("plane_reaction", Part("plane", "ground"))
    assert parse_name("ball.reaction.x") is parse_name("cone.ball.reaction.x") is None


def test_parts_are_listed_in_the_order_of_the_family_that_has_them_all():
    inputs, fixed = ["b", "d"], ["a", "c"]
    names = [
        *variable_names("plane_point", inputs),
        *variable_names("fixed_plane_point", fixed),
        *variable_names("plane_friction", ["a", "b", "c", "d"]),
        *variable_names("pin_reaction", ["e"]),
        "sphere.f.friction",
    ]
    assert part_names(names, "plane") == ["a", "b", "c", "d"] and part_names(names, "pin") == ["e"]
    assert part_names(names, "load") == [] and parts_of(names, *OBSTACLES)[-1] == Part("sphere", "f")
    some_inputs = [*variable_names("pin_position", ["b"]), *variable_names("pin_reaction", ["a", "b", "c"])]
    assert part_names(some_inputs, "pin") == ["a", "b", "c"]


@pytest.mark.parametrize("row", table()["family"], ids=lambda row: row["key"])
def test_flat_names_mean_what_the_structured_ones_mean(row):
    instance = instance_of(row)
    names, own = variable_names(row["key"], [instance], flat=True), vector_names(row["key"], instance)
    assert all(re.fullmatch(r"[A-Za-z0-9_]+", name) for name in names)
    assert [parse_name(name) for name in names] == [parse_name(name) for name in own]
    assert [other_form(name) for name in own] == (names if names != own else [None] * len(own))
    assert [structured(name) for name in [*names, *own]] == [*own, *own]


def test_parts_whose_names_look_like_points_keep_their_names():
    for name in ("load.position_0_1_2.x", "plane.force_1_1_1.friction", "probe._0_0_0.z"):
        assert structured(flat_form(name)) == name and parse_name(name) == parse_name(flat_form(name)) is not None


def test_a_flat_name_is_that_of_the_part_with_the_shortest_name():
    assert structured("plane_a_angular_velocity_x") == "plane.a.angular_velocity.x"
    assert mistaken(Part("plane", "a_angular")) == "plane.a_angular.velocity.x"
    assert mistaken(Part("plane", "a_b")) is mistaken(Part("pin", "position")) is mistaken(Part("box", "point")) is None


@pytest.mark.parametrize("flat", [False, True])
def test_either_form_finds_what_is_there(flat):
    name = variable_name("position", (0, 1, 2), "x", flat=flat)
    values = ByName({name: 7.0, "mass": 1.0})
    assert values["position[0,1,2].x"] == values["position_0_1_2_x"] == values.get("position_0_1_2_x") == 7.0
    assert "position[0,1,2].x" in values and "position_0_1_2_x" in values and list(values) == [name, "mass"]
    assert "position_0_1_3_x" not in values and values.get("nothing") is None and 3 not in values
    with pytest.raises(KeyError):
        values["position_0_1_3_x"]
