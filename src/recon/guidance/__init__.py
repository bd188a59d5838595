"""From what is wanted to how it is flown: steering, and paths for the whole fleet."""
