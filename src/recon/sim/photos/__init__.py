"""Photos of survey drones over the simulated land, as files that a card would hold.

Pure: a photo is a function of its pose, time and the settings, to the bit.
"""
