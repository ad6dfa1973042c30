"""Programs that users start: the command line and the page in the browser."""
