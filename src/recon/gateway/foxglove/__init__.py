"""A station's vehicles, maps and log live in Foxglove and Lichtblick, under the record's topics.

    station's states, audit, pictures --> messages --> topics of a server --> clients

Messages are made by the functions that make those of a record, so a layout for records fits. What
is live is shown, each sample once, and nothing else: a lost vehicle's topics stop, and all do while
the station's states do not come. Clients read only.
"""
