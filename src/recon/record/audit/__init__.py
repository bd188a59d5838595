"""The audit: lines chained by hashes, written as they happen, checked afterwards."""
