"""The motion of the reduced system with its derivatives with respect to the start and ν_s.

`deviations` carries the derivatives in the Taylor series of the motion, `variational` integrates
from event to event, and `period_map` gives the map over a period. `curves` corrects and follows
periodic orbits.
"""
