"""The linear model about rest, and what shakes it."""
