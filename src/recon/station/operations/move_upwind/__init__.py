"""The move upwind: the imaging drone flies to where it sees more of the shade that comes.

`search` has a worker propose places while a survey that allows it runs, `execution` begins a move
once one is better for long enough, and advances it with every tick. A person moves it by a goto.
What it shares with the look aside is in `imager_motion`.
"""

from recon.station.operations.move_upwind.conditions import audit_entries, conditions
from recon.station.operations.move_upwind.execution import advance
from recon.station.operations.operation import Operation

MOVE_UPWIND = Operation(
    name="move upwind", tick=advance, conditions=conditions, audit=audit_entries
)
