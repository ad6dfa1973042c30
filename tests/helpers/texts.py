"""Texts of study files with pieces replaced."""


def replaced(text: str, *pairs: tuple[str, str]) -> str:
    """The text with each old piece, which must be there once, as the new one: no test passes by accident."""
    for old, new in pairs:
        assert text.count(old) == 1, f"{old!r} is {text.count(old)} times in the text"
        text = text.replace(old, new)
    return text
