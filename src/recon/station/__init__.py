"""The only composition root: one pure step over one queue of events, and the drivers around it.

Its rooms import downwards only: host, recording, kernel, api_views, audit, recovery, alarms,
operations, imaging, control, steering, failsafe, traffic, state.
"""
