from antenna_pin.apps.fmu.export import export_fmu as export_fmu
