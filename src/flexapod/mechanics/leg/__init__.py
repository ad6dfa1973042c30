"""The equations: one file for each chapter part of docs/theory."""
