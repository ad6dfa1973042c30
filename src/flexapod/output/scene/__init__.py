"""Where things are: the geometry of a mechanism and of a result, for page, report and figures."""
