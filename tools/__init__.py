"""Programs for those who develop and publish flexapod; none is part of the package."""
