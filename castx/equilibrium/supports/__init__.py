"""Supports of bodies that contact does not hold: springs and in-gates.

Public: `springs.FloatingMotions`, `in_gates.InGate`, `first_contact.FirstContact`,
`acting.Supports`
"""
