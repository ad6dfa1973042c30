"""Numbers as they were: what a change of the inside must not change.

`python -m tests.golden [cases]` writes them anew. That is right only where a number is meant to change, and then the
change belongs in CHANGELOG.md.
"""
