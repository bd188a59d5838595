"""api_views."""
