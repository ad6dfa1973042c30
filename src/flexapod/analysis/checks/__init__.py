"""What is known of a study before it runs: checks, estimates, its description in words."""
