from antenna_pin.show.views.numbers import RunNumbers as RunNumbers
from antenna_pin.show.views.runs import Drawing as Drawing
from antenna_pin.show.views.runs import RunFigures as RunFigures
from antenna_pin.show.views.studies import StudyFigures as StudyFigures
from antenna_pin.show.views.studies import figures_of_study as figures_of_study
