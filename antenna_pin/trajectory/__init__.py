"""One run, sampled: labelled arrays by a schema, how the run ended, and the file that holds both."""

from antenna_pin.base.lazy import exported

exported(__name__)
