from antenna_pin.studies.margins.factors import FACTOR_SETS as FACTOR_SETS
from antenna_pin.studies.margins.factors import WORDS_OF_RESISTANCE as WORDS_OF_RESISTANCE
from antenna_pin.studies.margins.factors import FactorSet as FactorSet
from antenna_pin.studies.margins.factors import Resistance as Resistance
from antenna_pin.studies.margins.motorization import margin as margin
from antenna_pin.studies.margins.result import MarginCase as MarginCase
from antenna_pin.studies.margins.result import MotorizationMargin as MotorizationMargin
