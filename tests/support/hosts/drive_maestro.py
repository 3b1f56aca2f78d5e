"""Runs one FMU in Maestro: python drive_maestro.py JARS JOB.json RESULT.json (see importers.Run); prints what Maestro logs of the FMU.

Maestro interprets a specification (MaBL), which is written here: one instance, stepped and read, its values to outputs.csv.
"""

import csv
import json
import subprocess
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree as Xml


def listed(kind: str, name: str, values: list) -> str:
    return f"{kind} {name}[{len(values)}] = {{{', '.join(map(repr, values))}}};"


def specification(job: dict, guid: str, references: dict[str, int]) -> str:
    """The run as MaBL: arrays for what is set and read, a loop over the steps."""
    inputs, outputs, counts = list(job["inputs"]), job["outputs"], job["counts"]
    lines = [
        f'FMI2 fmu = load("FMI2", "{guid}", "{Path(job["fmu"]).as_uri()}");',
        'DataWriter writer = load("DataWriter");',
        'FMI2Component body = fmu.instantiate("body", false, true);',
        "int status = 0; real time = 0.0;",
        f"status = body.setupExperiment(false, 0.0, 0.0, true, {job['step'] * job['steps']!r});",
    ]
    if job["start"]:
        lines += [listed("uint", "starts", [references[name] for name in job["start"]]), listed("real", "start", [*job["start"].values()])]
        lines += [f"status = body.setReal(starts, {len(job['start'])}, start);"]
    lines += ["status = body.enterInitializationMode();", "status = body.exitInitializationMode();"]
    lines += [f"string heads[{len(outputs + counts)}] = {{{', '.join(f'{chr(34)}{name}{chr(34)}' for name in outputs + counts)}}};"]
    lines += ["DataWriterConfig table = writer.writeHeader(heads);"]
    blocks = (("real", "read", outputs), ("int", "counted", counts), ("real", "driven", inputs))
    for kind, name, names in blocks:
        if names:
            lines += [listed("uint", f"{name}References", [references[each] for each in names]), f"{kind} {name}[{len(names)}];"]
    lines += [listed("real", f"course{n}", job["inputs"][name]) for n, name in enumerate(inputs)]
    lines += ["int n = 0;", f"while (n < {job['steps']}) {{"]
    if inputs:
        lines += [f"driven[{n}] = course{n}[n];" for n in range(len(inputs))]
        lines += [f"status = body.setReal(drivenReferences, {len(inputs)}, driven);"]
    lines += [f"time = n * {job['step']!r};", f"status = body.doStep(time, {job['step']!r}, false);"]
    lines += ['if (status > 1) { error "doStep"; }']
    if outputs:
        lines += [f"status = body.getReal(readReferences, {len(outputs)}, read);"]
    if counts:
        lines += [f"status = body.getInteger(countedReferences, {len(counts)}, counted);"]
    cells = [f"read[{n}]" for n in range(len(outputs))] + [f"counted[{n}]" for n in range(len(counts))]
    lines += [f"writer.writeDataPoint({', '.join(['table', 'time', *cells])});", "n = n + 1;", "}"]
    lines += ["writer.close();", "status = body.terminate();", "fmu.freeInstance(body);", "unload(fmu);", "unload(writer);"]
    imports = "".join(f"import {module}; " for module in ("DataWriter", "DataWriterConfig", "FMI2", "FMI2Component"))
    return f"simulation {imports}\n{{\n" + "\n".join(lines) + "\n}\n"


def main() -> None:
    jars, job, result = sys.argv[1], json.loads(Path(sys.argv[2]).read_text()), Path(sys.argv[3])
    folder = result.parent
    with zipfile.ZipFile(job["fmu"]) as archive:
        description = Xml.fromstring(archive.read("modelDescription.xml"))
    references = {each.get("name"): int(each.get("valueReference")) for each in description.iter("ScalarVariable")}
    (folder / "run.mabl").write_text(specification(job, description.get("guid"), references))
    (folder / "run.json").write_text(json.dumps({"DataWriter": [{"filename": "outputs.csv", "type": "CSV"}]}))
    (folder / "outputs.csv").unlink(missing_ok=True)
    maestro = ["java", "-cp", f"{jars}/*", "org.intocps.maestro.Main", "interpret", "-runtime=run.json", "run.mabl"]
    done = subprocess.run(maestro, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    for log in [done.stdout, *(path.read_text() for path in folder.glob("body.log"))]:
        print(log)
    if done.returncode == 0 and (folder / "outputs.csv").is_file():
        _, *rows = csv.reader((folder / "outputs.csv").open())
        split = 1 + len(job["outputs"])
        table = {"outputs": [list(map(float, row[1:split])) for row in rows], "counts": [list(map(int, row[split:])) for row in rows]}
        result.write_text(json.dumps(table))
    sys.exit(done.returncode)


main()
