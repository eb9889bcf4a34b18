from antenna_pin.studies import fit as fit
from antenna_pin.studies import linear as linear
from antenna_pin.studies import margins as margins
from antenna_pin.studies import nonlinear as nonlinear
from antenna_pin.studies import sensitivity as sensitivity
from antenna_pin.studies import statics as statics
from antenna_pin.studies import sweep as sweep
from antenna_pin.studies import verification as verification
