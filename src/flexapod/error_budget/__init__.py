"""The error budget: what every part adds to the error of the tool, and how it adds up."""

from flexapod.error_budget.dataset import budget

__all__ = ["budget"]
