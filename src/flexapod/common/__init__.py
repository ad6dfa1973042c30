"""Needs of the package from the machine: files, processes, threads, late imports."""
