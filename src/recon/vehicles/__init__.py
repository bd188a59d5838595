"""Packets to reports and commands to packets: the only room that interprets the ICD's values."""
