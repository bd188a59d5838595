"""Steering, and the paths of the whole fleet."""
