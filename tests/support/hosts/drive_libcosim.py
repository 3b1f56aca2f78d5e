"""Runs one FMU in libcosim: python drive_libcosim.py JOB.json RESULT.json (see importers.Run)."""

import json
import sys

from libcosimpy.CosimEnums import CosimVariableType
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave


def done(success, what):
    if not success:
        sys.exit(f"libcosim: {what} failed")


with open(sys.argv[1]) as file:
    job = json.load(file)
log_output_level(CosimLogLevel.INFO)
execution = CosimExecution.from_step_size(round(job["step"] * 1e9))
slave = CosimLocalSlave(job["fmu"], "body")
done(slave.ptr(), "loading the FMU")
body = execution.add_local_slave(slave)
variables = execution.slave_variables(body)
described = {v.name.decode(): (CosimVariableType(v.type), v.reference) for v in variables}


def references(names, kind):
    assert all(described[name][0] == kind for name in names)
    return [described[name][1] for name in names]


real, integer = CosimVariableType.REAL, CosimVariableType.INTEGER
observer, override = CosimObserver.create_last_value(), CosimManipulator.create_override()
done(execution.add_observer(observer), "adding an observer")
done(execution.add_manipulator(override), "adding a manipulator")
for reference, value in zip(references(job["start"], real), job["start"].values(), strict=True):
    done(execution.real_initial_value(body, reference, value), "setting a start value")
inputs, outputs = references(job["inputs"], real), references(job["outputs"], real)
counts = references(job["counts"], integer)
rows = {"outputs": [], "counts": []}
for step in range(job["steps"]):
    if inputs:
        values = [course[step] for course in job["inputs"].values()]
        done(override.slave_real_values(body, inputs, values), "setting inputs")
    done(execution.step(), f"step {step}")
    rows["outputs"].append(list(observer.last_real_values(body, outputs)))
    rows["counts"].append(list(observer.last_integer_values(body, counts)) if counts else [])
with open(sys.argv[2], "w") as file:
    json.dump(rows, file)
