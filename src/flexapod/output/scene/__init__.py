"""Geometry of a mechanism and of a result, for the page, reports, figures and exports."""
