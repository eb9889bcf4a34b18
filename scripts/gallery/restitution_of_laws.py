"""The restitution that is asked for, and the one that comes.

Most damping laws were derived for nearly elastic blows. Asked for 0.5, some deliver 0.7: lines are closed
forms, circles are blows that were integrated.
"""

from antenna_pin.analysis.law_studies import restitution_table
from antenna_pin.show.plot import figure_restitution

figure = figure_restitution(restitution_table(asked=(0.2, 0.4, 0.6, 0.8, 0.95)))
