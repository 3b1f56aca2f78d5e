"""An FMU of another program, in C: one variable of each type, whose value references are unique within their type only."""

import shutil
import subprocess
import zipfile
from pathlib import Path

import fmpy

COMPILER = shutil.which("cc")

SOURCE = r"""
#include <stdlib.h>
#include <string.h>
typedef struct { double r, u; int count, level, open, on; char word[32]; } Model;
#define CALL(name, ...) int fmi2##name(Model* m, ##__VA_ARGS__)
#define EACH(what) { for (size_t k = 0; k < n; ++k) what; return 0; }
#define GET(Type, type, from) CALL(Get##Type, const unsigned v[], size_t n, type x[]) EACH(x[k] = from)
#define SET(Type, type, to) CALL(Set##Type, const unsigned v[], size_t n, const type x[]) EACH(to)
const char* fmi2GetTypesPlatform(void) { return "default"; }
const char* fmi2GetVersion(void) { return "2.0"; }
void* fmi2Instantiate(const char* n, int t, const char* g, const char* r, const void* f, int v, int l) {
  Model* m = calloc(1, sizeof *m);
  m->count = 42, m->level = 2, strcpy(m->word, "hello");
  return m;
}
void fmi2FreeInstance(void* m) { free(m); }
GET(Real, double, v[k] == 0 ? m->r : m->u)
GET(Integer, int, v[k] == 0 ? m->count : m->level)
GET(Boolean, int, v[k] == 0 ? m->open : m->on)
GET(String, const char*, m->word)
SET(Real, double, if (v[k] == 1) m->u = x[k])
SET(Integer, int, *(v[k] == 0 ? &m->count : &m->level) = x[k])
SET(Boolean, int, if (v[k] == 1) m->on = x[k])
SET(String, char*, strncpy(m->word, x[k], 31))
CALL(DoStep, double t, double h, int p) { m->r = m->on ? m->u : -m->u, m->open = t < 0.05; return 0; }
CALL(Reset) { m->r = m->u = m->on = 0; return 0; }
CALL(SetupExperiment, int a, double b, double c, int d, double e) { return 0; }
#define EMPTY(name, status) CALL(name) { return status; }
EMPTY(SetDebugLogging, 0) EMPTY(EnterInitializationMode, 0) EMPTY(ExitInitializationMode, 0) EMPTY(Terminate, 0)
EMPTY(GetFMUstate, 3) EMPTY(SetFMUstate, 3) EMPTY(FreeFMUstate, 3) EMPTY(SerializedFMUstateSize, 3) EMPTY(SerializeFMUstate, 3)
EMPTY(DeSerializeFMUstate, 3) EMPTY(GetDirectionalDerivative, 3) EMPTY(SetRealInputDerivatives, 3) EMPTY(GetRealOutputDerivatives, 3)
EMPTY(CancelStep, 3) EMPTY(GetStatus, 3) EMPTY(GetRealStatus, 3) EMPTY(GetIntegerStatus, 3) EMPTY(GetBooleanStatus, 3)
EMPTY(GetStringStatus, 3)
"""

DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="other" guid="{1}">
<CoSimulation modelIdentifier="other" canHandleVariableCommunicationStepSize="true"/>
<TypeDefinitions><SimpleType name="Level"><Enumeration><Item name="low" value="1"/><Item name="high" value="2"/></Enumeration></SimpleType>
</TypeDefinitions><DefaultExperiment startTime="0" stopTime="0.1" stepSize="0.01"/><ModelVariables>
<ScalarVariable name="Größe &quot;r&quot;, m" valueReference="0" causality="output"><Real/></ScalarVariable>
<ScalarVariable name="u" valueReference="1" causality="input"><Real start="0"/></ScalarVariable>
<ScalarVariable name="count" valueReference="0" causality="parameter" variability="tunable"><Integer start="42"/></ScalarVariable>
<ScalarVariable name="level" valueReference="1" causality="output" variability="discrete">
<Enumeration declaredType="Level"/></ScalarVariable>
<ScalarVariable name="open" valueReference="0" causality="output" variability="discrete"><Boolean/></ScalarVariable>
<ScalarVariable name="on" valueReference="1" causality="input" variability="discrete"><Boolean start="false"/></ScalarVariable>
<ScalarVariable name="word" valueReference="0" causality="output" variability="discrete"><String/></ScalarVariable>
<ScalarVariable name="said" valueReference="1" causality="parameter" variability="tunable"><String start="hello"/></ScalarVariable>
</ModelVariables><ModelStructure><Outputs><Unknown index="1"/><Unknown index="4"/><Unknown index="5"/><Unknown index="7"/></Outputs>
</ModelStructure></fmiModelDescription>
"""


def build_other_fmu(path: Path) -> Path:
    """Compiles it and writes it to a path."""
    library = path.with_suffix(".so")
    subprocess.run([COMPILER, "-w", "-shared", "-fPIC", "-x", "c", "-", "-o", library], input=SOURCE, text=True, check=True)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION)
        archive.write(library, f"binaries/{fmpy.platform}/other.so")
    return path
