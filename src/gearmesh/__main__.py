"""Run the command as ``python -m gearmesh``."""

import sys

from gearmesh.cli import main

sys.exit(main())
