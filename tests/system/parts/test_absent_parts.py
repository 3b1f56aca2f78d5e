"""What a scene does not use does not exist in its FMU: neither variables nor records."""

from xml.etree import ElementTree

import pytest

from scenes import GRAVITY, box
from softffd.fmu.package import scene_texts

PLAIN = box(stiffness=1e3, damping=0.0, outputs={"positions": [[0, 0, 0]], "reactions": True})

ALWAYS = {"mass", "stiffness.edge", "stiffness.face", "stiffness.body", "solver.method", "solver.tolerance", "solver.step"}
ALWAYS_RECORDS = {"guid", "counts", "origin", "size", "topology", "mass", "stiffness", "positions", "initial", "reactions"}
ALWAYS_RECORDS |= {"stop_time", "method", "tolerance", "step", "most_work"}

PLANE = ("point", "normal", "velocity", "angular_velocity", "reaction", "torque", "centre")
PIN = ("position", "orientation", "velocity", "angular_velocity", "reaction", "torque")

ENERGIES = {f"energy.{name}" for name in ("kinetic", "elastic", "dissipated", "work")}
PINNED = {"name": "a", "points": "z-"}
PARTS = {
    "damping": ({"material.damping": 0.1}, {"damping"}, {"damping"}),
    "gravity": ({"environment.gravity": [0, 0, -9]}, {f"gravity.{c}" for c in "xyz"}, {"gravity"}),
    "plane": (
        {"plane": [{"name": "q"}]},
        {f"plane.q.{what}.{c}" for what in PLANE for c in "xyz"} | {"plane.q.friction", "plane.q.contacts"},
        {"plane"},
    ),
    "pin": ({"pin": [PINNED]}, {f"pin.a.{what}.{c}" for what in ("reaction", "torque") for c in "xyz"}, {"pin"}),
    "pin moved by input": (
        {"pin": [{**PINNED, "motion": "input"}]},
        {f"pin.a.{what}.{c}" for what in PIN for c in "xyz"} | {"pin.a.orientation.w"},
        {"pin", "pin_inputs"},
    ),
    "load": ({"load": [{"name": "l", "points": "z-"}]}, {f"load.l.{c}" for c in "xyz"}, {"load"}),
    "forces": ({"inputs.forces": [[1, 2, 3]]}, {f"force[1,2,3].{c}" for c in "xyz"}, {"forces"}),
    "probe": ({"probe": [{"name": "o", "at": [0.5, 0.5, 0.5]}]}, {f"probe.o.{c}" for c in "xyz"}, {"probe"}),
    "velocities": ({"outputs.velocities": [[1, 2, 3]]}, {f"velocity[1,2,3].{c}" for c in "xyz"}, {"velocities"}),
    "energy": ({"outputs.energy": True}, ENERGIES, {"energy"}),
    "energy and gravity": (
        {"outputs.energy": True, "environment.gravity": GRAVITY},
        ENERGIES | {"energy.gravity"} | {f"gravity.{c}" for c in "xyz"},
        {"energy", "gravity"},
    ),
    "solver": (
        {"outputs.solver": True},
        {f"solver.{what}" for what in ("steps", "rejected", "contacts_resolved", "stable_step", "folded_cells")},
        {"solver"},
    ),
    "stiffness of a region": ({"region": [{"points": "z-", "stiffness": 5.0}]}, set(), {"region_stiffness"}),
    "volume stiffness": ({"material.volume_stiffness": 9e3}, set(), {"volume_stiffness"}),
    "matched inertia": ({"mass.inertia": "matched"}, set(), {"weight"}),
    "one thread": ({"solver.threads": 1}, set(), set()),
    "two threads": ({"solver.threads": 2}, set(), {"threads"}),
}
"""Changes of the plain scene, the variables and the records that they bring."""


def contents(scene):
    """Names of the variables and keys of the records of a scene's FMU."""
    texts, _, _ = scene_texts(scene)
    description = ElementTree.fromstring(texts["modelDescription.xml"])
    records = texts["resources/scene.txt"].decode().splitlines()[1:]
    names = [variable.get("name") for variable in description.iter("ScalarVariable")]
    assert len(names) == len(set(names))
    return set(names), {record.split()[0] for record in records}


def test_a_plain_scene_has_nothing_but_its_own_parameters_and_outputs():
    names, records = contents(PLAIN)
    assert names == ALWAYS | {f"position[0,0,0].{c}" for c in "xyz"}
    assert records - {"reactions"} == ALWAYS_RECORDS - {"reactions"}


@pytest.mark.parametrize("part", PARTS)
def test_each_part_brings_its_own_variables_and_records_and_no_others(part):
    changes, variables, keys = PARTS[part]
    (plain, records), (names, more) = contents(PLAIN), contents(PLAIN.replace(changes))
    assert plain <= names and names - plain == variables
    assert more - records == keys


def test_reactions_that_are_not_wanted_are_absent():
    touched = {"plane": [{"name": "q"}], "pin": [{"name": "a", "points": "z+"}]}
    names, records = contents(PLAIN.replace({"outputs.reactions": False, **touched}))
    assert not any("reaction" in name or "torque" in name or "centre" in name or "contacts" in name for name in names)
    assert "reactions" not in records
