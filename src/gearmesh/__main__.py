"""Run the command as ``python -m gearmesh``."""

import sys

from gearmesh.commands.main import main

sys.exit(main())
