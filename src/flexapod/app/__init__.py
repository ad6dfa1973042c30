"""What people start: command line and page."""
