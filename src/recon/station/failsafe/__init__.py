"""The failsafe matrix at work: what each vehicle does, which conditions hold, what is due.

It orders nothing itself: `kernel/failsafe_orders.py` places what it requests.
"""
