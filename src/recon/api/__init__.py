"""HTTP and WebSocket API.

Routes validate requests against `schema/`, call the `StationPort` and return its views; the web
console and the Python client use nothing else. Access is checked before any route (`security.py`).
Nothing here knows the station: `station/api_views/service.py` implements the port.
"""
