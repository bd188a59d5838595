"""Files that are replaced as a whole, atomically: snapshot, users, a site's layers with undo."""
