"""The command line. It reads Datasets and descriptions, never a solver's internals."""
