"""Named results of recordings: deviations by cause, remarks and the summary."""
