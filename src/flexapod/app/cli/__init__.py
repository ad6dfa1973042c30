"""What users start: the command line and its reports. Reads Datasets and descriptions, never a solver's internals."""
