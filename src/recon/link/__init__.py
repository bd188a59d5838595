"""Companion apps' connections: sessions without IO, and the thin TCP server around them."""
