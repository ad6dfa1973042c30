"""Programs about the tests: faults that they do not see, damaged files by the thousand, wheels, older processors."""
