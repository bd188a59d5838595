"""The async Python client of a running station."""
