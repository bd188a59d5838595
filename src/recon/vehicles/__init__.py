"""Packets to reports, commands to packets: the only place where the ICD's values get a meaning."""
