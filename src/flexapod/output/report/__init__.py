"""A result as one page to read: words, tables, figures, replay."""
