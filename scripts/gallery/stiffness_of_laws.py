"""Force over depth: the elastic laws for one pin in one bore.

A steel pin of 10 mm in a bore that is 0.2 mm wider, 50 mm long. Hertz's law of a sphere and the laws of a
line contact differ by more than any uncertainty of the material, and more where the play is small: a law is
part of the model.
"""

from antenna_pin.analysis.law_studies import elastic_laws_of_joint
from antenna_pin.contact import MATERIALS
from antenna_pin.show.plot import figure_force_curves

steel = MATERIALS["steel"]
laws = elastic_laws_of_joint(
    bearing_radius=5.05e-3, journal_radius=4.95e-3, length=50e-3, bearing=steel, journal=steel
)
figure = figure_force_curves(laws)
