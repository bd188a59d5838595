"""Flight records as MCAP: values as bytes, messages, chunks, a writing process, and repair."""
