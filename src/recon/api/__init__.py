"""The HTTP and WebSocket face of the station, and the console's files."""
