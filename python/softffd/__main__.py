"""The command `softffd`, also as python -m softffd."""

import sys


def main() -> int:
    """Runs the command line; returns its exit status. An interrupt ends it quietly during its imports too."""
    try:
        from softffd.cli.command import main as run

        return run()
    except KeyboardInterrupt:
        print("softffd: interrupted", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
