"""Photos as cameras and people leave them: what each file states, and which belong together."""
