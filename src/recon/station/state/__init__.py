"""The station's state: frozen values that every room reads, and the types of a step.

`station.Station` holds it all. `steps` has what a step returns: outputs for drivers, jobs for the
worker. It decides nothing and imports no other room.
"""
