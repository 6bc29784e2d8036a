"""Errors for refused input, and warnings about assumptions."""


class InputError(ValueError):
    """Input was refused. The text is the line that the command `hil` prints: what is wrong, where, why, and how to mend it."""


class MissingFileError(InputError, FileNotFoundError):
    """A file does not exist."""


class NotFittedError(ValueError, AttributeError):
    """A law was asked for a force before it was fitted or loaded."""


class GuessWarning(UserWarning):
    """The meaning of a column was not certain, and was guessed. The text is the note that the command `hil` prints."""


class UnitWarning(GuessWarning):
    """A unit was assumed, because neither the column's name nor `units` gives it."""
