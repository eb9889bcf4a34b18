"""Readers bound to results: ``run.plot``, ``run.record``, ``run.report``, ``run.analyse`` and others.

Every reader here is bound to a result by the table ``antenna_pin.base.views.VIEWS``. It draws, records and
reports by the rooms below, and adds what those who have a result at hand leave unsaid: which run it is.
"""

from antenna_pin.base.lazy import exported

exported(__name__)
