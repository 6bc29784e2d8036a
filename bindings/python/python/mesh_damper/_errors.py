"""What is refused, and what is assumed."""


class InputError(ValueError):
    """Input that was refused. Its text is the line that the command `hil` prints: what, where, why, and how to mend it."""


class MissingFileError(InputError, FileNotFoundError):
    """A file that is not there."""


class NotFittedError(ValueError, AttributeError):
    """A law that was asked for a force before it was fitted or loaded."""


class GuessWarning(UserWarning):
    """What a column of a recording was taken for without being sure. Its text is the note that the command `hil` prints."""


class UnitWarning(GuessWarning):
    """A unit that neither a column's name nor `units` says, and that was assumed."""
