"""One time step: passes between heat and mechanics."""
