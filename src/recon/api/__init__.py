"""HTTP and WebSocket: schemas, login and roles, streams, the console's files.

Access is checked before any route (`security.py`). Routes that read or change the station are in
`station/api_views/`; the web console and the Python client use nothing else.
"""
