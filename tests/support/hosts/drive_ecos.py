"""Runs one FMU in Ecos: python drive_ecos.py JOB.json RESULT.json (see importers.Run); prints Ecos's log."""

import ctypes
import json
import sys
from pathlib import Path

for library in Path(sys.prefix).glob("lib*/libtbb.so.12"):  # of the package tbb; Ecos asks for this name
    ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)

from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure  # noqa: E402

with open(sys.argv[1]) as file:
    job = json.load(file)
EcosLib.set_log_level("debug")  # the level at which it shows what the FMU reports, errors included
rows = {"outputs": [], "counts": []}
with EcosSimulationStructure() as structure:
    structure.add_model("body", job["fmu"])
    start = {f"body::{name}": float(value) for name, value in job["start"].items()}
    structure.add_parameter_set("start", start)
    with EcosSimulation(structure=structure, step_size=job["step"]) as simulation:
        simulation.init(parameter_set="start")
        for step in range(job["steps"]):
            for name, course in job["inputs"].items():
                simulation.set_real(f"body::{name}", course[step])
            simulation.step()
            rows["outputs"].append([simulation.get_real(f"body::{name}") for name in job["outputs"]])
            rows["counts"].append([simulation.get_integer(f"body::{name}") for name in job["counts"]])
        simulation.terminate()
with open(sys.argv[2], "w") as file:
    json.dump(rows, file)
