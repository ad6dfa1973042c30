"""`flexapod view`: a study or its results as a web page; `server.View`."""
