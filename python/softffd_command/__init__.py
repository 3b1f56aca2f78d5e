"""The command `softffd`. It stands beside the package, whose imports take half a second, so that an interrupt ends it quietly there too."""

import sys


def main() -> int:
    """Runs the command line of softffd.cli; returns its exit status."""
    try:
        from softffd.cli.command import main as run

        return run()
    except KeyboardInterrupt:
        print("softffd: interrupted", file=sys.stderr)
        return 130
