"""python -m softffd"""

import sys

from softffd.cli.command import main

if __name__ == "__main__":
    sys.exit(main())
