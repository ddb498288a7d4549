"""Heat-transfer coefficient of a node pair as a function of gap, pressure and temperature."""
