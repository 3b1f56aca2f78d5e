"""What the model description of a large lattice costs: processor time against an element tree of the same elements, in the same run.

    python benchmarks/description_cost.py [SIDE]     # 32, the largest, by default: 98,000 variables

The tree is how descriptions were made before: every attribute spelled out, indented, then written. Processor time, smallest of three; the
ratio is what to read.

Predicted: four elements and twelve attributes a variable in the tree, then two walks over them, 30 us; a line of text for it 2 us, its two
lines in the structure 1 us: 0.1. Bytes: 40 of 336 are blanks, 50 are defaults: 0.75.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from xml.etree import ElementTree as Xml

from softffd.fmu.description_parts import dependencies, its_values
from softffd.fmu.model_description import model_description
from softffd.fmu.package import scene_masses
from softffd.fmu.variables import Variable, variables
from softffd.scene.scene import scene_from

INITIAL = {"parameter": "exact", "output": "calculated"}


def main() -> None:
    """Prints the table."""
    side = int((sys.argv[1:] or ["32"])[0])
    scene = scene_from({"lattice": {"points": [side] * 3, "basis": "bspline"}})
    listed = variables(scene, scene_masses(scene).mass)
    base, tree = smallest(lambda: as_a_tree(listed))
    own, text = smallest(lambda: model_description(scene, listed))
    print(f"{len(listed)} variables     seconds   ratio      MB   ratio")
    print(f"as a tree            {base:7.2f}    1.00 {len(tree) / 1e6:7.1f}    1.00")
    print(f"model_description    {own:7.2f} {own / base:7.2f} {len(text) / 1e6:7.1f} {len(text) / len(tree):7.2f}")


def as_a_tree(listed: list[Variable]) -> str:
    """Variables and structure, made as elements."""
    root = Xml.Element("fmiModelDescription")
    parent = Xml.SubElement(root, "ModelVariables")
    for variable in listed:
        family = variable.family
        what = {"name": variable.name, "valueReference": str(variable.reference), "causality": family["causality"]}
        what |= {"variability": family["variability"], "description": variable.description}
        if family["causality"] in INITIAL:
            what["initial"] = INITIAL[family["causality"]]
        start = () if variable.start is None else (variable.start,)
        Xml.SubElement(Xml.SubElement(parent, "ScalarVariable", what), family.get("type", "Real"), its_values(variable, start))
    structure = Xml.SubElement(root, "ModelStructure")
    direct, initial = Xml.SubElement(structure, "Outputs"), Xml.SubElement(structure, "InitialUnknowns")
    for index, known in dependencies(listed, lambda variable: variable.place):
        Xml.SubElement(direct, "Unknown", index=index, dependencies="")
        Xml.SubElement(initial, "Unknown", index=index, dependencies=known)
    Xml.indent(root)
    return Xml.tostring(root, encoding="unicode")


def smallest(make: Callable[[], str]) -> tuple[float, str]:
    """The smallest of three processor times [s], and what is made."""
    times, made = [], ""
    for _ in range(3):
        began = time.process_time()
        made = make()
        times.append(time.process_time() - began)
    return min(times), made


if __name__ == "__main__":
    main()
