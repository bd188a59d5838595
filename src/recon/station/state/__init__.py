"""The station's state: frozen values that every room reads, and the types of a step.

`station.Station` holds it all. `outputs` and `jobs` have what a step asks the drivers to do,
`stepped` the types of steps and handlers. It decides nothing and imports no other room.
"""
