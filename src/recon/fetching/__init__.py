"""Fetching before leaving base: politely, bounded in time and size, resumed after an interruption.

Redirects are not followed. No station imports this room: nothing is fetched at the field.
"""
