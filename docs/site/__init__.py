"""The documentation as a site: ``python -m docs.site`` builds it of what is in the repository, into ``build/site``."""
