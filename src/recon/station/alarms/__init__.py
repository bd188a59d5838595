"""Alarms.

Every tick `conditions.py` derives what is wrong from the station's state, and `state/alarm_book.py`
turns conditions into alarms that begin, continue and end. Events without a duration (messages from
an app, faults in the station's own code) are noted and stay until acknowledged. An alarm states
what, its value and limit, and what to do.
"""
