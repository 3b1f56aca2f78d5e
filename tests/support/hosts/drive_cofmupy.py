"""Runs one FMU in CoFMUPy: python drive_cofmupy.py JOB.json RESULT.json (see importers.Run); prints what it says.

CoFMUPy sets all inputs, to 0 where nobody gives them a value: they are given their starts. It reads all outputs as Reals.
"""

import json
import sys

from cofmupy import Coordinator
from fmpy import read_model_description

with open(sys.argv[1]) as file:
    job = json.load(file)
inputs = [v for v in read_model_description(job["fmu"]).modelVariables if v.causality == "input"]
starts = {v.name: float(v.start) for v in inputs} | {name: course[0] for name, course in job["inputs"].items()}
body = {"id": "body", "path": job["fmu"], "name": "body", "initialization": job["start"] | starts}
coordinator = Coordinator()
coordinator.start({"fmus": [body], "connections": [], "cosim_method": "jacobi", "iterative": False, "edge_sep": " -> "})
held = {name: [value] for name, value in starts.items()}
rows = {"outputs": [], "counts": []}
for step in range(job["steps"]):
    given = held | {name: [course[step]] for name, course in job["inputs"].items()}
    read = coordinator.master.do_step(job["step"], {"body": given})["body"]
    rows["outputs"].append([float(read[name][0]) for name in job["outputs"]])
    rows["counts"].append([int(read[name][0]) for name in job["counts"]])
with open(sys.argv[2], "w") as file:
    json.dump(rows, file)
