"""The aircraft: flight controller modes, kinematics, missions, battery, and the air around it.

All positions are metres north and east of the aircraft's home point, heights are above it.
What DJI's SDK would reject is rejected here too (`acceptance`).
"""
