"""What an order makes its vehicle fly: interpreted once, for every question safety asks.

`order_path` turns an order into one of five motions (`Mission`, `StraightFlight`, `StickFlight`,
`HoldPath`, `TakeoffClimb`). Three kinds of question use them, each in the form it needs:

- fences, heights and keep-out zones: volumes without times (`volumes.py`), everything the vehicle
  may touch, the route home by its own failsafe included;
- energy: points and a speed (`recon.safety.energy`);
- separation: rows with times and uncertainty (`recon.safety.prediction`).

Their bounds differ on purpose and are named settings. A stick is flown for its timeout; a
`StickBounds` states what is added to that: nothing for energy, braking for fences, and reaction
and braking for separation, which must include every place two vehicles could meet.
"""
