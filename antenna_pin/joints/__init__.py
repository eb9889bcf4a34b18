"""The joint-contact plugin: geometry + laws + contact memory -> the wrench on a joint with play."""

from antenna_pin._lazy import exported

exported(__name__)
