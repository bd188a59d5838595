"""The station as the API sees it.

`service.py` implements the API's port: requests become events for the driver, and `*_view`
functions turn the station's state into the messages of `api/schema/`. Views only read the state.
"""
