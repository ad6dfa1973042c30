"""A study as a file: presets, key paths, reference, JSON schema."""
