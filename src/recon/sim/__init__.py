"""Simulated companion apps that speak the real protocol, and the world they fly in.

Everything but `run` and `proxy` is pure: time is an argument and random numbers are seeded, so the
same seed and commands give the same bytes. The ground under an aircraft is flat, at the height of
its home point.

Imports go downwards only: run, proxy -> fleet -> app -> camera -> flight -> land -> world.
`connected_apps` and `fork` are for worlds in virtual time: apps on a driver, and copies of it all.
"""
