"""The command `softffd`, which can also be started as python -m softffd."""

import signal
import sys
from pathlib import Path


def main() -> int:
    """Runs the command line and returns its exit status. An interrupt ends the command quietly, also during its imports. SIGTERM, which
    `timeout`, `docker stop` and batch systems send, counts as an interrupt: what is done so far is kept, and temporary files are
    deleted."""
    ends_at_once = signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
    if ends_at_once:
        signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        from softffd.cli.command import main as run

        return run()
    except KeyboardInterrupt:
        print("softffd: interrupted", file=sys.stderr)
        return 130
    except ModuleNotFoundError as error:
        if (error.name or "softffd").startswith("softffd"):
            raise
        script = Path(__file__).parents[1] / "run.py"  # exists in a clone
        finish = f"to finish it: python3 {script} scenes" if script.is_file() else "to install it: pip install softffd"
        print(f"softffd: the package {error.name} is not installed, as after a set-up that was interrupted; {finish}", file=sys.stderr)
        return 1
    finally:
        if ends_at_once:
            signal.signal(signal.SIGTERM, signal.SIG_DFL)


if __name__ == "__main__":
    sys.exit(main())
