"""The joint-contact plugin: geometry + laws + contact memory -> the wrench on a joint with play."""

from antenna_pin.base.lazy import exported

exported(__name__)
