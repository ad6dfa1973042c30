"""Independent reference solutions. Plain NumPy/SciPy: nothing here may import the package under test."""
