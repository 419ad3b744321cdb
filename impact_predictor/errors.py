"""The one exception of this package."""


class InputError(ValueError):
    """A file, a parameter or an argument is wrong; the message is one sentence: what, where, what to do."""
