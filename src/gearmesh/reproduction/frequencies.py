"""The mesh frequencies ν_s that the paper names."""

FIRST, LAST = 0.6, 1.2
"""Range of ν_s in Figs. 2, 3 and 5."""

FIG_4 = (0.60, 1.05, 1.20)
"""Frequencies of the phase planes and time courses of Fig. 4."""

FIRST_JUMP = 0.66
"""Lower jump of the response curves with lubricant damping (Figs. 2 and 3)."""

LOOP_END = 0.64
"""End of the further branches in Detail X of Fig. 3."""

CROSSING = 0.61
"""Where y_max with 5k exceeds that with k (Fig. 6). Fig. 7 prints no frequency; its text names
this one."""
