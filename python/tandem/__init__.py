"""Solvers for tandem in Python: see tandem.participant."""
