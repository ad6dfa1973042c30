"""The cache of compiled kernels, for those who look after their disk."""

from flexapod.symbolic.cache import CacheContent, cache_content, clear_cache

__all__ = ["CacheContent", "cache_content", "clear_cache"]
