"""Restart in flight.

A thread writes a checked snapshot of what must outlive the process; a start reads it back and
restores order ids, authority, lost vehicles and interrupted orders. Nothing is sent.
"""
