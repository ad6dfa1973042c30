"""The error budget: contributions of all parts to the error of the tool, and their sums."""

from flexapod.analysis.error_budget.budget_dataset import budget

__all__ = ["budget"]
