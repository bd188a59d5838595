"""After the flight: which photos are in sun, from a flight's record and the drones' cards."""
