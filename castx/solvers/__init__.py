"""PETSc: numbering, nonlinear and linear solvers, diagnosis."""
