"""Pages of runs, and what they hold."""

import base64
import json
import re
from dataclasses import replace

import numpy as np

from made_up_run import made_up_run
from mesh_files import two_colours
from softffd.lattice import rest_grid
from softffd.mesh.mesh import load_mesh
from softffd.show.view import write_view


def run_of(page):
    return json.loads(re.search(r'<script type="application/json" id="run">(.*?)</script>', page.read_text("utf-8"))[1])


def decoded(text, kind, width):
    return np.frombuffer(base64.b64decode(text), kind).reshape(-1, width).astype(float)


def page_of_two_colours(folder, name):
    mesh = load_mesh(two_colours(folder, name))
    origin, size = mesh.bounds[0], np.ptp(mesh.bounds, axis=0)
    result = made_up_run()
    still = replace(result, positions=np.tile(rest_grid((4, 4, 4), origin, size), (len(result.time), 1, 1, 1, 1)))
    page = write_view(still, folder / "view.html", mesh=mesh, origin=origin, size=size)
    return run_of(page), page
