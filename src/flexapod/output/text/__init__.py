"""Text on results, written once for terminal, page and data: sections, sentences and tables."""
