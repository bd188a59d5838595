"""Long runs that show what a test's few seconds cannot: `make study`. Each has a short test."""
