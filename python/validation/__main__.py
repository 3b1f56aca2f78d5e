"""Entry point `python -m validation TOOL`, through which `python3 python/run.py` runs the tools."""

import sys

from softffd.cli.command import exit_status
from validation.tools import run_tool

if __name__ == "__main__":
    sys.exit(exit_status(run_tool))
