"""Laws of contact and friction, to be found by completion: ``antenna_pin.laws.<TAB>``.

Those of the normal force take depth and rate, those of friction slip; a law of damping makes an elastic one
lossy (:class:`~antenna_pin.contact.DampedContact`). Parameters are in SI units. :data:`NORMAL_LAWS`,
:data:`FRICTION_LAWS` and :data:`DISSIPATIONS` map their names in scenario files to the classes. Materials and
stiffnesses of a pair are in :mod:`antenna_pin.contact`.
"""

from antenna_pin.base.lazy import exported

exported(__name__)
