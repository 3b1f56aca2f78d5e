"""Pages of runs, and what they hold."""

import base64
import json
import re

import numpy as np

from made_up_run import at_rest_about
from mesh_files import two_colours
from softffd.mesh.files import load_mesh
from softffd.show.view import write_view


def run_of(page):
    return json.loads(re.search(r'<script type="application/json" id="run">(.*?)</script>', page.read_text("utf-8"))[1])


def decoded(text, kind, width):
    return np.frombuffer(base64.b64decode(text), kind).reshape(-1, width).astype(float)


def page_of_two_colours(folder, name):
    mesh = load_mesh(two_colours(folder, name))
    page = write_view(at_rest_about(mesh), folder / "view.html")
    return run_of(page), page
