"""Materials: property tables, solid fraction, enthalpy, flow rules and the database."""
