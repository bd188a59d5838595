"""Evaluation after the flight: which photos are in sun, from its record and the drones' cards."""
