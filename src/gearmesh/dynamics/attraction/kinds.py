"""Kinds of long-run motion. Code that only reads results needs these names, but no solver."""

PERIODIC = "periodic"
"""A stable orbit."""

NEUTRAL = "neutral"
"""Motion that the mesh no longer damps."""

QUASI_PERIODIC = "quasi-periodic"
"""Motion that fills a closed curve."""

CHAOTIC = "chaotic"
"""Motion whose neighbours part exponentially."""

MOVING = "moving"
"""Motion that still changes after the transient."""

LOST = "lost"
"""A run that failed, so its long-run motion is unknown."""

KINDS = (PERIODIC, NEUTRAL, QUASI_PERIODIC, CHAOTIC, MOVING, LOST)
"""All kinds."""
