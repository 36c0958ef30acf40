"""The workspace of the sweep: the data of the run in each lane, and its progress.

It is one flat float64 array of rows, one element of a row for each lane; the names below are row
numbers. The regime, the segment of the mesh period and whether a period is kept are whole numbers
in their rows, so that one instruction compares them in all lanes.
"""

ORDER = 18
"""Degree of the Taylor polynomials."""

N_PLACES = 4
"""Places of a step where its motion is evaluated to find events, evenly up to its end."""

MAX_SEGMENTS = 6
"""Most segments of a mesh period."""

Y, B = 0, ORDER + 1
"""First rows of the series of y and b; the state is Y, Y + 1, B, B + 1."""

_STATE = 2 * (ORDER + 1)
(
    # The equation of motion, see `gearmesh.solvers.reduced.taylor`.
    ELASTIC,  # c, 0 in contact loss
    OFFSET,  # y_0, where the flanks begin to touch
    LINEAR,  # k_1
    QUADRATIC,  # k_2
    CUBIC,  # k_3
    FRICTION,  # g
    LOAD,  # 1; 0 in an idle lane
    TWO_MU,  # 2 m_red/m
    BEARING_STIFFNESS,  # w^2
    BEARING_DAMPING,  # 2 zeta w
    # The step.
    LONGEST,  # bound of a step
    LOG_TOLERANCE,  # log2 of the local error tolerance
    STEP,  # length of the expansion
    TAKEN,  # what is taken of it, up to the first event
    EVENT,  # what ends the step, see `gearmesh.solvers.reduced.events`
    # What is watched for events.
    SIGN,  # direction of motion, sign of v
    LEVEL_ABOVE,  # level that a rising y crosses into the next regime
    LEVEL_BELOW,  # level that a falling y crosses
    GUARD,  # 1 or -1: watch y, which must stay above or below OFFSET; 0: watch v
    # The place in the run.
    REGIME,  # of `gearmesh.model.contact`
    SEGMENT,  # of the mesh period
    PERIOD,  # mesh periods done
    KEPT,  # 1 in the kept revolutions, else 0
    SINCE_SEGMENT,  # time since the segment began
    LENGTH,  # of that segment
    REMAINING,  # time to its end, a switch, pitch point or boundary
    SINCE_BOUNDARY,  # time since the mesh period began
    STEPS,  # steps taken
    # What is measured.
    SQUARE_INTEGRAL,  # of y^2 over the kept time
    LOSS_TIME,  # kept time in contact loss
    INVERSE_TIME,  # kept time in inverse mesh
    CONTACT_LOSSES,  # how often contact was lost in the kept time
    # The run.
    BACKLASH,  # s
    FARTHEST,  # |y| at which the run has diverged
    SEGMENTS,  # in a mesh period
    PERIODS,  # mesh periods in all
    FIRST_KEPT,  # the first that is kept
    MOST_STEPS,  # steps after which the run is given up
) = range(_STATE, _STATE + 38)

MATERIAL = MOST_STEPS + 1
"""First of three rows with k_1, k_2 and k_3 where flanks touch."""

LUBRICANT = MATERIAL + 3
"""First of three rows with k_1, k_2 and k_3 in the backlash."""

SEGMENT_LENGTH, SEGMENT_STIFFNESS, SEGMENT_FRICTION = (
    LUBRICANT + 3 + MAX_SEGMENTS * i for i in range(3)
)
"""First rows of what belongs to the segments: their lengths, c and g."""

PLACE_Y, PLACE_V, PLACE_HALF_A = (SEGMENT_FRICTION + MAX_SEGMENTS + N_PLACES * i for i in range(3))
"""First rows of y, v and half the acceleration at the places of a step."""

N_ROWS = PLACE_HALF_A + N_PLACES
