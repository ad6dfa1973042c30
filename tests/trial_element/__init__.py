"""A package from outside with an element of its own, as `docs/an-element-of-your-own.md` shows it."""
