"""Two free bodies meet inside a joint: a blow, and what it leaves of their speed.

The model `impact_pair`: a disc in a bore that is a tenth of a millimetre wider, on a free base, in no
gravity. Each blow turns the disc back by the restitution of its law, so that the next comes later; the
momentum of both stays.
"""

from antenna_pin import load_scenario, simulate

run = simulate(load_scenario("impact_pair", overrides={"clearance.bore.geometry": "closed-form"}))
print(run.analyse.impacts()["restitution"].values.round(3))
figure = run.plot("contact_forces")
