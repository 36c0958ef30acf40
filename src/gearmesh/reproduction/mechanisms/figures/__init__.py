"""The figures of "Why it jumps", each from datasets to a matplotlib figure."""
