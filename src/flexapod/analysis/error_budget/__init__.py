"""The error budget: what every part adds to the error of the tool, and how it adds up."""

from flexapod.analysis.error_budget.budget_dataset import budget

__all__ = ["budget"]
