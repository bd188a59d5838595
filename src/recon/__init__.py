"""Recon: a ground control station for several DJI drones over fields."""
