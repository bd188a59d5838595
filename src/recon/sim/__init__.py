"""Simulated companion apps that speak the real wire: vehicles, camera, faults and their shell.

Everything but `run` is pure: time is an argument and randomness is seeded. The aircraft's ground is
flat, at the height of its home point.
"""
