"""Errors for invalid input, and warnings about assumptions."""


class InputError(ValueError):
    """Invalid input. The text is the line that the command `hil` prints: the error, its place, the reason and the remedy."""


class MissingFileError(InputError, FileNotFoundError):
    """A file does not exist."""


class NotFittedError(ValueError, AttributeError):
    """A law was used before it was fitted or loaded."""


class GuessWarning(UserWarning):
    """The meaning of a column was guessed. The text is the note that the command `hil` prints."""


class UnitWarning(GuessWarning):
    """A unit was assumed, because neither the column's name nor `units` states it."""
