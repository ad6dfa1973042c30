"""What is told of a result, once: sections, sentences and tables, for the terminal, for a page, as data."""
