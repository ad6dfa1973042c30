"""From what was recorded to named results, causes, remarks and the summary."""
