"""The local page `castx app`: a thin server for one user, beside one folder of case files.

What the page does is done by the functions and commands of the command line, and stands in the
case file.

Public: `serving.serve`, `workplace.Workplace`, `guard.Guard`, `actions.Actions`.
"""
