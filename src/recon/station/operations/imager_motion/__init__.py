"""Motions of an imaging drone under guidance: side-steps and moves upwind.

`side_step` and `move_upwind` are the two kinds: each decides what begins a motion and where it
leads. `claim` gives guidance the imaging drone, `execution` follows the order and ends the motion,
`notices` states what an operator must know. A relief (`imager_relief`) shares these three.
"""

from recon.station.operations.imager_motion.move_upwind import MOVE_UPWIND
from recon.station.operations.imager_motion.side_step import SIDE_STEP

IMAGER_MOTIONS = (SIDE_STEP, MOVE_UPWIND)
"""All motions in the order of their ticks; a fault in one leaves the other running."""
