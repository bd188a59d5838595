"""Recon: a ground control station for several DJI drones over fields."""

from importlib.metadata import version

__version__ = version("recon-gcs")
