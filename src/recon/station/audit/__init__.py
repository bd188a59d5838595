"""The audit: what happened and who asked, for operators and accident investigation.

`entries.py` derives the entries of each step from the states before and after it; the auditor hands
them to `record/audit/audit_log.py`, which chains and writes them on a thread of its own, and to
the log printer. It is append-only and never read back: a restart reads the recovery snapshot.
"""
