import sys

from softffd_command import main

sys.exit(main())
