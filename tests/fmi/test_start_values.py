"""The start values of the description are those of the component."""

from scenes import LED, MOVED, box
from softffd.fmu.component import Component

SCENE = box(
    stiffness={"edge": 900.0, "face": 450.0, "body": 200.0},
    damping=0.3,
    gravity=[0.1, 0.2, -9.81],
    mass={"total": 2.5},
    forces=[[3, 3, 3]],
    plane=[
        {
            "name": "lid",
            "point": [0.1, 0.2, 1.3],
            "normal": [0.1, 0.0, -1.0],
            "velocity": [0.0, 0.3, 0.4],
            "angular_velocity": [0.5, 0.6, 0.7],
            "friction": 0.2,
            **MOVED,
        },
        {
            "name": "floor",
            "point": [0.3, 0.4, -0.5],
            "normal": [0.0, 0.2, 1.0],
            "velocity": [0.1, 0.2, -0.3],
            "angular_velocity": [0.4, 0.5, 0.6],
            "friction": 0.6,
        },
    ],
    pin=[{"name": "hand", "points": [[0, 0, 3], [3, 0, 3], [0, 3, 3], [1, 2, 2]], **LED}],
    load=[{"name": "wind", "points": "x+"}],
    method="leapfrog",
    tolerance=2e-4,
    step=1e-3,
)


def test_what_the_description_calls_a_start_value_is_what_the_component_starts_with():
    with Component(SCENE) as component:
        component.set_up()
        described = {name: variable.start for name, variable in component.by_name.items() if variable.causality != "output"}
        read = {name: component.block([name]).get()[0] for name in described}
    assert len(described) == 56
    assert {name: float(start) for name, start in described.items()} == read
