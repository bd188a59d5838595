"""Processes of our own beside the main one: their limits, and their end."""
