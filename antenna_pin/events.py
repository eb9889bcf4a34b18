"""Events of runs, to be found by completion: ``antenna_pin.events.<TAB>``.

An :class:`Event` is a function of a :class:`Moment` that passes zero, or one of :class:`Angle`,
:class:`Rate`, :class:`Gap`, :class:`Force`, :class:`Time` and :class:`ElementChange`; what it does is
:class:`Mark`, :class:`Stop`, :class:`Set` or :class:`Jump`. Given to ``simulate(events=[...])``.
"""

from antenna_pin.base.lazy import exported

exported(__name__)
