"""The relief: an imaging drone takes the place of one whose battery ends, or returns to its own.

`outlook` predicts when each must return and what the surveys need, `commands` begins a relief,
`execution` advances it, `automatic` begins one for a survey that allows it and recalls what must
leave (`return_home`). What it shares with the other motions is in `imager_motion`.
"""

from recon.model.event import ReliefOrdered
from recon.station.operations.imager_relief.commands import audit_entries, order_relief
from recon.station.operations.imager_relief.conditions import conditions
from recon.station.operations.imager_relief.execution import advance, on_shade
from recon.station.operations.imager_relief.outlook import on_position
from recon.station.operations.operation import Operation
from recon.station.state.steps import on

IMAGER_RELIEF = Operation(
    name="relief of an imaging drone",
    tick=advance,
    conditions=conditions,
    commands=(on(ReliefOrdered, order_relief),),
    audit=audit_entries,
    on_position=on_position,
    on_shade=on_shade,
)
